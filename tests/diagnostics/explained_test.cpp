// SPDX-License-Identifier: MIT
// The words of all diagnoses for each way of the bytes, and for each case.
#include <gtest/gtest.h>

#include <dlfcn.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <string_view>

#include "diagnostics/agreement.hpp"
#include "diagnostics/doctor_bench.hpp"
#include "diagnostics/odd_links.hpp"
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "transport/pty.hpp"

/// Whether the system refuses devices, as it does in a container that may not use them.
static bool is_refused = false;

/// The linker prefers it to that of the C library.
extern "C" int access(const char* path, int mode) noexcept {
  using function = int(const char*, int);
  static auto* const real = reinterpret_cast<function*>(::dlsym(RTLD_NEXT, "access"));
  if (is_refused && mode != F_OK && std::string_view(path).starts_with("/dev/")) {
    errno = EPERM;
    return -1;
  }
  return real(path, mode);
}

namespace {

using namespace g4lidar;
using namespace g4lidar::test;

/// Each diagnosis in each stage, as in a report of a run.
template <class Look>
void each_explained(byte_path by, error_detail detail, Look look) {
  for (std::size_t stage = 0; stage < diagnostic_stage_count; ++stage) {
    for (std::size_t what = 0; what < diagnosis_count; ++what) {
      const stage_report report{
          .stage = static_cast<diagnostic_stage>(stage), .by = by, .detail = detail};
      look(report, static_cast<diagnosis>(what));
    }
  }
}

/// Diagnoses of what a network cannot have: a port of this computer.
bool is_of_port(diagnosis what) {
  switch (what) {
    case diagnosis::no_port:
    case diagnosis::several_ports:
    case diagnosis::not_serial:
    case diagnosis::permission:
    case diagnosis::busy:
    case diagnosis::bad_baud_rate:
      return true;
    default:
      return false;
  }
}

TEST(Explained, OfANetwork_BlamesNoLine) {
  each_explained(byte_path::network, error_detail::usual,
                 [](const stage_report& report, diagnosis what) {
                   if (is_of_port(what)) return;
                   SCOPED_TRACE(describe(what).name);
                   const diagnosis_info info = report.explain(what);
                   expect_no_line(info.cause);
                   expect_no_line(info.advice);
                   for (const char* const word : {"fuser", "udev", "unplug", "port of the host"})
                     EXPECT_EQ(info.advice.find(word), std::string_view::npos) << info.advice;
                   for (const diagnosis other : info.alternatives) {
                     EXPECT_NE(other, diagnosis::line_noise);
                     EXPECT_NE(other, diagnosis::usb_latency);
                   }
                 });
}

TEST(Explained, OfAFile_AdvisesNothingAtAPort) {
  for (const diagnosis what :
       {diagnosis::unknown_bytes, diagnosis::changed_bytes, diagnosis::wrong_baud_rate,
        diagnosis::no_zero_angle, diagnosis::stalls, diagnosis::bits_flipped,
        diagnosis::bytes_dropped, diagnosis::bytes_inserted, diagnosis::bursts,
        diagnosis::packets_truncated, diagnosis::packets_lost, diagnosis::line_noise}) {
    const diagnosis_info info = stage_report{.by = byte_path::file}.explain(what);
    SCOPED_TRACE(info.name);
    expect_no_line(info.cause);
    expect_no_line(info.advice);
    for (const char* const word : {"fuser", "unplug", "the port exists", "plug it in"}) {
      EXPECT_EQ(info.cause.find(word), std::string_view::npos);
      EXPECT_EQ(info.advice.find(word), std::string_view::npos);
    }
  }
}

TEST(Explained, HasNameAndSeverityOfTheDiagnosis) {
  for (const byte_path by : {byte_path::line, byte_path::network, byte_path::file}) {
    for (int i = 0; i <= static_cast<int>(last_error_detail); ++i) {
      each_explained(by, static_cast<error_detail>(i),
                     [](const stage_report& report, diagnosis what) {
                       const diagnosis_info info = report.explain(what);
                       EXPECT_EQ(info.name, describe(what).name);
                       EXPECT_EQ(info.severity, describe(what).severity);
                       EXPECT_TRUE(info.cause.ends_with('.')) << info.cause;
                       EXPECT_TRUE(info.advice.ends_with('.')) << info.advice;
                     });
    }
  }
}

// Each error of the library has its own advice in the doctor, too.
TEST(Explained, OfAnErrorWithACase_HasItsAdvice) {
  for (const auto& [what, detail] : {std::pair(problem::permission, error_detail::not_passed),
                                     std::pair(problem::no_port, error_detail::other_bridges),
                                     std::pair(problem::no_port, error_detail::missing_port),
                                     std::pair(problem::no_port, error_detail::not_attached),
                                     std::pair(problem::bad_option, error_detail::bad_name)}) {
    failing_connector from(what, detail);
    examined done;
    done.stages = diagnose(from);
    const error expected(task::opening, what, {}, 0, detail);
    const stage_report* failed = nullptr;
    for (const stage_report& each : done.stages) {
      if (!each.diagnoses.empty()) failed = &each;
    }
    ASSERT_NE(failed, nullptr) << done;
    EXPECT_EQ(failed->explain(failed->diagnoses.front()).advice, expected.advice()) << done;
    EXPECT_NE(status_of(*failed, "").message.find(expected.advice()), std::string::npos);
  }
}

TEST(Explained, DeviceThatTheContainerMayNotUse) {
  const pty port;
  is_refused = true;
  examined done;
  done.stages = diagnose(port.path());
  is_refused = false;
  EXPECT_EQ(done.diagnoses(), "permission") << done;
  const stage_report& stage = done.at(diagnostic_stage::permission);
  const diagnosis_info info = stage.explain(diagnosis::permission);
  EXPECT_NE(info.advice.find("docker run --device"), std::string_view::npos) << info.advice;
  EXPECT_EQ(info.advice.find("udev"), std::string_view::npos) << info.advice;
  EXPECT_EQ(info.cause.find("This user"), std::string_view::npos) << info.cause;
}

// Where packets cannot be read as the named model, to insist does not help.
TEST(Explained, OfAnotherDevice_AdvisesToInsistOnANumberOnly) {
  each_explained(
      byte_path::line, error_detail::usual, [](const stage_report& report, diagnosis what) {
        if (what != diagnosis::other_device) return;
        const bool insists = report.explain(what).advice.find("insist") != std::string_view::npos;
        EXPECT_EQ(insists, report.stage == diagnostic_stage::identity);
      });
  for (const error_detail detail : {error_detail::other_samples, error_detail::other_maker,
                                    error_detail::unsupported_product}) {
    const stage_report report{.stage = diagnostic_stage::identity, .detail = detail};
    const std::string_view advice = report.explain(diagnosis::other_device).advice;
    EXPECT_EQ(advice.find("insist"), std::string_view::npos) << advice;
  }
}

}  // namespace
