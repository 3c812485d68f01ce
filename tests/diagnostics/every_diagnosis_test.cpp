// SPDX-License-Identifier: MIT
// Each diagnosis occurs at least once, here or in the table of faults.
#include <gtest/gtest.h>

#include <dlfcn.h>
#include <sys/resource.h>
#include <termios.h>

#include <algorithm>
#include <functional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "diagnostics/doctor_bench.hpp"
#include "diagnostics/odd_links.hpp"
#include "g4lidar/transport/serial_port.hpp"
#include "transport/pty.hpp"
#include "transport/temporary_file.hpp"

/// Whether ports have another baud rate than the one that was set, as with a bridge that cannot do it.
static bool has_other_rate = false;

/// The linker prefers it to that of the C library.
extern "C" int tcgetattr(int fd, termios* out) noexcept {
  using function = int(int, termios*);
  static auto* const real = reinterpret_cast<function*>(::dlsym(RTLD_NEXT, "tcgetattr"));
  const int got = real(fd, out);
  if (has_other_rate) ::cfsetspeed(out, B115200);
  return got;
}

namespace {

using namespace g4lidar;
using namespace g4lidar::test;

struct scenario {
  std::string_view name;
  std::string_view diagnoses;
  std::function<examined()> run;
};

void PrintTo(const scenario& one, std::ostream* out) { *out << one.name; }

examined on_source(const std::string& source) {
  examined done;
  done.stages = diagnose(source);
  return done;
}

/// The bytes of a port, as somebody has copied them from a screen.
examined on_text() {
  const temporary_file file("AA 55 00 28 A9 74 09 85 CA 8C AD 2B 58 2C 08 2D\n");
  return on_source("file:" + file.path());
}

/// Opening fails, for this reason.
examined with_failing(problem what) {
  failing_connector from(what);
  examined done;
  done.stages = diagnose(from);
  return done;
}

examined on_link(const wrapper& wrap, const sim::device_options& options = {}) {
  sim::device simulated(sim::built_in_world(), options);
  sim::virtual_clock clock;
  return examine(simulated, clock, {}, wrap);
}

/// The process may not open further files.
examined without_descriptors() {
  const pty port;
  rlimit before{};
  EXPECT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit none{0, before.rlim_max};
  EXPECT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  examined done = on_source(port.path());
  EXPECT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
  return done;
}

examined on_busy_port() {
  const pty port;
  const auto held = serial_port::open(port.path());
  EXPECT_TRUE(held.has_value());
  return on_source(port.path());
}

examined on_slow_bridge() {
  const pty port;
  has_other_rate = true;
  examined done = on_source(port.path());
  has_other_rate = false;
  return done;
}

sim::device_options with(const std::function<void(sim::device_options&)>& change) {
  sim::device_options options;
  change(options);
  return options;
}

const std::vector<scenario> scenarios{
    {"no_port", "no_port", [] { return on_source("/dev/no_such_port"); }},
    {"not_serial", "not_serial", [] { return on_source("/dev/null"); }},
    {"cannot_connect", "cannot_connect", [] { return on_source("tcp:127.0.0.1:1"); }},
    {"system", "system", without_descriptors},
    {"busy", "busy", on_busy_port},
    {"bad_file", "bad_file", [] { return on_source("file:/dev/no_such_file"); }},
    {"several_ports", "several_ports", [] { return with_failing(problem::several_ports); }},
    {"permission", "permission", [] { return with_failing(problem::permission); }},
    {"bad_baud_rate", "bad_baud_rate", on_slow_bridge},
    {"interference_at_opening", "interference", [] { return with_failing(problem::interference); }},
    {"interference", "interference",
     [] { return on_link(wrap_in<broken_link>(4'000'000'000, problem::interference)); }},
    {"broken", "system",
     [] { return on_link(wrap_in<broken_link>(4'000'000'000, problem::system)); }},
    {"does_not_start", "does_not_start", [] { return on_link(wrap_in<link_without_start>()); }},
    {"scan_ends", "scan_ends", [] { return on_link(wrap_in<link_that_stops>()); }},
    {"line_noise", "line_noise", [] { return on_link(wrap_in<noisy_link>()); }},
    {"sample_rate_off", "sample_rate_off",
     [] { return on_link(wrap_in<lying_link>(response_kind::byte)); }},
    {"frequency_off", "frequency_off",
     [] { return on_link(wrap_in<lying_link>(response_kind::frequency)); }},
    {"other_device", "other_device",
     [] { return examine(with([](auto& options) { options.info.model = 52; })); }},
    {"number_that_no_model_has", "other_number",
     [] { return examine(with([](auto& options) { options.info.model = 99; })); }},
    {"changed_bytes", "changed_bytes", on_text},
    {"loop_back", "no_lidar", [] { return on_link(wrap_in<echoing_link>(std::string())); }},
    {"console", "no_lidar",
     [] { return on_link(wrap_in<echoing_link>(std::string("\r\nrobot login: "))); }},
    {"motor_stuck", "motor_stuck",
     [] { return examine(with([](auto& options) { options.standstill_ns = 60'000'000'000; })); }},
    {"motor_unsteady", "motor_unsteady",
     [] {
       return examine(with([](auto& options) {
         options.motor_drift_ppm = 100'000;
         options.motor_drift_period_ns = 500'000'000;
       }));
     }},
    {"protection_on", "protection_on",
     [] {
       return examine(
           with([](auto& options) { options.initial.protection = power_down_protection::on; }));
     }},
    {"packets_lost", "packets_lost",
     [] { return examine(with([](auto& options) { options.scanner.samples_per_packet = 10; })); }},
    {"host_busy", "host_busy",
     [] {
       sim::device simulated(sim::built_in_world(), {});
       sim::virtual_clock clock;
       return examine(simulated, clock, {},
                      wrap_in<paused_host>(&clock, 4'000'000'000, 300'000'000));
     }},
};

class Diagnosis : public ::testing::TestWithParam<scenario> {};

TEST_P(Diagnosis, IsReportedAndNoOther) {
  const examined done = GetParam().run();
  EXPECT_EQ(done.diagnoses(), GetParam().diagnoses) << done;
  EXPECT_FALSE(done.motor_turns) << done;
}

INSTANTIATE_TEST_SUITE_P(All, Diagnosis, ::testing::ValuesIn(scenarios),
                         [](const auto& one) { return std::string(one.param.name); });

TEST(Diagnoses, EachOneHasATest) {
  std::string all = diagnoses_of_faults() + diagnoses_of_beliefs();
  for (const scenario& one : scenarios) all.append(one.diagnoses).append(" ");
  std::istringstream words(all);
  std::vector<std::string> found;
  for (std::string name; words >> name;) found.push_back(name);
  for (std::size_t i = 0; i < diagnosis_count; ++i) {
    const std::string_view name = describe(static_cast<diagnosis>(i)).name;
    EXPECT_EQ(std::count(found.begin(), found.end(), name) > 0, true) << name;
  }
}

// The diagnosis and the stage of a failing connection: all other stages are passed or not reached.
TEST(Diagnoses, OfAConnection_AreReportedInTheirStage) {
  const std::vector<std::pair<problem, std::string_view>> expected{
      {problem::no_port, "port"},
      {problem::several_ports, "port"},
      {problem::not_serial, "port"},
      {problem::cannot_connect, "port"},
      {problem::system, "port"},
      {problem::permission, "permission"},
      {problem::busy, "holder"},
      {problem::interference, "holder"},
      {problem::bad_baud_rate, "baud_rate"}};
  for (const auto& [what, stage] : expected) {
    const examined done = with_failing(what);
    ASSERT_EQ(done.stages.size(), diagnostic_stage_count) << done;
    bool is_before = true;
    for (const stage_report& each : done.stages) {
      const bool is_it = name_of(each.stage) == stage;
      is_before = is_before && !is_it;
      const stage_verdict otherwise = is_before ? stage_verdict::ok : stage_verdict::skipped;
      EXPECT_EQ(each.outcome, is_it ? stage_verdict::fail : otherwise) << done;
    }
  }
}

}  // namespace
