// SPDX-License-Identifier: MIT
// The running diagnosis of a healthy lidar: no diagnosis, whatever the program does, and constant memory.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "diagnostics/odd_links.hpp"
#include "diagnostics/running_bench.hpp"
#include "support/allocation_count.hpp"
#include "support/test_scale.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::test;
using namespace std::chrono_literals;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t second = 1'000 * ms;

double number_of(const std::vector<stage_report>& stages, diagnostic_stage where,
                 std::string_view name) {
  for (const stage_report& stage : stages) {
    if (stage.stage != where) continue;
    for (const evidence& each : stage.measurements) {
      if (each.name != name) continue;
      const auto* whole = std::get_if<std::int64_t>(&each.value);
      return whole != nullptr ? static_cast<double>(*whole) : std::get<double>(each.value);
    }
  }
  return -1.0;
}

/// The verdicts, "ok ok ok skipped".
std::string verdicts(const std::vector<stage_report>& stages) {
  std::string text;
  for (const stage_report& stage : stages) {
    text.append(text.empty() ? "" : " ").append(name_of(stage.outcome));
  }
  return text;
}

TEST(RunningHealthy, HasNoDiagnosis_AndReportsItsMeasurements) {
  for (const int seed : test::seeds(6)) {
    use how;
    how.device.scanner.seed = static_cast<std::uint64_t>(seed);
    how.takes_points = seed % 2 == 0;
    const seen found = watch(how);
    ASSERT_EQ(found.diagnoses(), "") << seed << found;
    const auto& last = found.looks.back();
    ASSERT_EQ(last.size(), 8U) << found;
    EXPECT_NEAR(number_of(last, diagnostic_stage::rate, "measured_hz"), 7.0, 0.05);
    EXPECT_NEAR(number_of(last, diagnostic_stage::rate, "sample_rate_hz"), 9000.0, 45.0);
    EXPECT_EQ(number_of(last, diagnostic_stage::loss, "samples_lost"), 0.0);
    const double window_s = number_of(last, diagnostic_stage::stream, "seconds");
    EXPECT_GE(window_s, 5.0);
    EXPECT_LE(window_s, 10.5);
  }
}

// The driver reads it by its samples, and so does the diagnosis: the number is all that is wrong.
TEST(RunningHealthy, WithSamplesThatContradictItsNumber_HasNoOtherDiagnosis) {
  for (const auto& [word, number] : {std::pair{"t-mini-plus-sh", "t-mini-plus"},
                                     {"t-mini-pro", "tg15"},
                                     {"t-mini-plus-sh", "tg30"}}) {
    use how;
    ASSERT_TRUE(sim::use_model(how.device, word));
    how.numbered = model_named(number);
    how.device.info.model = how.numbered->ids[0];
    const seen found = watch(how);
    EXPECT_EQ(found.diagnoses(), "other_number") << word << found;
  }
}

TEST(RunningHealthy, OtherModels_HaveNoDiagnosis) {
  for (const std::string_view word :
       {"x4", "x2", "x4-pro", "t-mini-pro", "t-mini-plus-sh", "g2", "g6", "tg30", "s4b", "scl"}) {
    use how;
    ASSERT_TRUE(sim::use_model(how.device, word));
    how.options.model = model_named(word);
    how.seconds = 12;
    const seen found = watch(how);
    ASSERT_EQ(found.diagnoses(), "") << word << found;
    const auto& last = found.looks.back();
    const double true_hz = how.device.scanner.scan_frequency_chz / 100.0;
    EXPECT_NEAR(number_of(last, diagnostic_stage::rate, "measured_hz"), true_hz, 0.01 * true_hz)
        << word << found;
    EXPECT_EQ(number_of(last, diagnostic_stage::loss, "samples_lost"), 0.0) << word << found;
  }
}

TEST(RunningHealthy, OtherModels_DamageIsFound) {
  for (const std::string_view word : {"x2", "t-mini-pro", "tg30"}) {
    use how;
    ASSERT_TRUE(sim::use_model(how.device, word));
    how.options.model = model_named(word);
    how.faults = faults_of({"drop"});
    how.seconds = 12;
    EXPECT_EQ(watch(how).diagnoses(), "bytes_dropped") << word;
  }
}

TEST(RunningHealthy, OtherDevices_HaveNoDiagnosis) {
  for (const int seed : test::seeds(4)) {
    for (const auto rate : {sample_rate::khz_4, sample_rate::khz_8}) {
      use how;
      how.device.scanner.seed = static_cast<std::uint64_t>(seed);
      how.device.scanner.sample_rate = rate;
      how.device.scanner.scan_frequency_chz = seed % 2 == 0 ? 500 : 1200;
      how.device.scanner.samples_per_packet = 24;
      how.device.stray_before_zero = true;
      how.device.boots_at_start = true;
      how.device.boot_text = true;
      how.options.sample_rate = rate;
      const seen found = watch(how);
      ASSERT_EQ(found.diagnoses(), "") << seed << found;
    }
  }
}

// Stop and start, questions and settings during a scan, and keep-alive commands.
TEST(RunningHealthy, PausesAndSettings_AreNotFaults) {
  use how;
  how.seconds = 60;
  how.each_second = [](lidar& device, std::int64_t now_s) {
    const auto nine = scan_frequency::hz(9);
    bool works = true;
    if (now_s % 13 == 0) works = device.stop().has_value();
    if (now_s % 13 == 3) works = device.start().has_value();
    if (now_s == 20) works = device.set(nine, while_scanning::stop_and_resume).has_value();
    if (now_s == 30) {
      works = device.ask(requests::health(), while_scanning::stop_and_resume).has_value();
    }
    EXPECT_TRUE(works) << now_s;
  };
  const seen found = watch(how);
  EXPECT_EQ(found.diagnoses(), "") << found;
  EXPECT_EQ(verdicts(found.looks.at(14)), "ok ok skipped skipped skipped skipped skipped skipped")
      << found;
  EXPECT_NEAR(number_of(found.looks.at(36), diagnostic_stage::rate, "set_hz"), 9.0, 0.001);
  EXPECT_NEAR(number_of(found.looks.at(36), diagnostic_stage::rate, "measured_hz"), 9.0, 0.07);
}

// The window forgets damage; what is plugged in again is not unplugged.
TEST(RunningHealthy, AfterAFault_IsOkAgain) {
  use how;
  how.faults = faults_of({"flip*0.01@6s+2s", "unplug@12s+1s"});
  how.options.reconnect = true;
  how.seconds = 60;
  const seen found = watch(how);
  EXPECT_NE(found.diagnoses(10), "") << found;
  EXPECT_EQ(found.diagnoses(12), "unplugged") << found;
  EXPECT_EQ(found.diagnoses(15), "") << found;
  EXPECT_EQ(found.diagnoses(40), "") << found;
}

TEST(RunningHealthy, APauseOfTheHost_IsNotAFaultOfTheLidar) {
  for (const bool takes_points : {false, true}) {
    for (const std::int64_t pause_ms : {50, 300, 1000}) {
      for (std::int64_t at_ms = 6'000; at_ms < 7'000; at_ms += 83) {
        sim::device simulated(sim::built_in_world(), {});
        sim::virtual_clock clock;
        running_diagnosis judge;
        auto from = std::make_unique<wrapping_connector>(
            std::make_unique<sim::virtual_connector>(simulated, clock),
            wrap_in<paused_host>(&clock, at_ms * ms, pause_ms * ms));
        auto device = lidar::open(judge.observe(std::move(from)));
        ASSERT_TRUE(device);
        ASSERT_TRUE(device->start());
        while (clock.now_ns() < 12 * second) {
          if (takes_points) {
            static_cast<void>(device->next_points(200ms));
          } else {
            static_cast<void>(device->try_scan(200ms));
          }
        }
        const seen found{{judge.stages()}};
        const std::string expected = pause_ms == 50 ? "" : "host_busy";
        EXPECT_EQ(found.diagnoses(), expected) << pause_ms << " at " << at_ms << found;
      }
    }
  }
}

// A program that works between two calls does not read the port during that time.
TEST(RunningHealthy, ABusyProgram_IsAPauseOfTheHost) {
  for (const std::int64_t work_ms : {20, 60, 400}) {
    sim::device simulated(sim::built_in_world(), {});
    sim::virtual_clock clock;
    running_diagnosis judge;
    auto device =
        lidar::open(judge.observe(std::make_unique<sim::virtual_connector>(simulated, clock)));
    ASSERT_TRUE(device);
    ASSERT_TRUE(device->start());
    while (clock.now_ns() < 12 * second) {
      static_cast<void>(device->try_scan(200ms));
      if (clock.now_ns() > 5 * second) clock.advance_to(clock.now_ns() + work_ms * ms);
    }
    const seen found{{judge.stages()}};
    EXPECT_EQ(found.diagnoses(), work_ms == 400 ? "host_busy" : "") << work_ms << found;
  }
}

// An event loop waits itself: the driver only reads what has arrived.
TEST(RunningHealthy, AnEventLoop_IsNotABusyHost) {
  for (const int rest_ms : {1, 70}) {
    sim::device simulated(sim::built_in_world(), {});
    sim::virtual_clock clock;
    running_diagnosis judge;
    auto device =
        lidar::open(judge.observe(std::make_unique<sim::virtual_connector>(simulated, clock)));
    ASSERT_TRUE(device);
    ASSERT_TRUE(device->start());
    while (clock.now_ns() < 12 * second) {
      static_cast<void>(device->try_scan(0ms));
      const std::int64_t next_ns = simulated.next_ns(clock.now_ns());  // as a poll would
      clock.advance_to(std::min(device->event_loop().next_deadline_ns(),
                                std::max(next_ns, clock.now_ns() + rest_ms * ms)));
    }
    const seen found{{judge.stages()}};
    EXPECT_EQ(found.diagnoses(), "") << rest_ms << found;
  }
}

// Hours of virtual time; nothing is allocated while it streams.
TEST(RunningHealthy, StaysOkForHours_InConstantMemory) {
  sim::device simulated(sim::built_in_world(), {});
  sim::virtual_clock clock;
  running_diagnosis judge;
  auto device =
      lidar::open(judge.observe(std::make_unique<sim::virtual_connector>(simulated, clock)));
  ASSERT_TRUE(device);
  ASSERT_TRUE(device->start());
  const std::int64_t end_ns = test::scaled(2) * 3'600 * second / 20;
  std::size_t allocations = 0;
  std::int64_t looked_ns = 0;
  while (clock.now_ns() < end_ns) {
    const std::size_t before = allocations_so_far();
    static_cast<void>(device->try_scan(200ms));
    if (clock.now_ns() > 30 * second) allocations += allocations_so_far() - before;
    if (clock.now_ns() < looked_ns + 30 * second) continue;
    looked_ns = clock.now_ns();
    const seen found{{judge.stages()}};
    ASSERT_EQ(found.diagnoses(), "") << looked_ns << found;
  }
  EXPECT_EQ(allocations, 0U);
}

}  // namespace
