// SPDX-License-Identifier: MIT
// A suspension of the program is not a fault of the lidar; nor is a motor that spins up slowly.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <string>
#include <variant>

#include "diagnostics/doctor_bench.hpp"
#include "diagnostics/odd_links.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::test;

constexpr std::int64_t ms = 1'000'000;

double number_of(const examined& done, diagnostic_stage where, std::string_view name) {
  for (const evidence& each : done.at(where).measurements) {
    if (each.name != name) continue;
    if (const auto* whole = std::get_if<std::int64_t>(&each.value)) {
      return static_cast<double>(*whole);
    }
    if (const auto* real = std::get_if<double>(&each.value)) return *real;
  }
  return -1.0;
}

/// Suspended at any time of the run: 1.5 s is during the queries, 4.1 s begins the measurement, 8.6
/// s ends it.
TEST(HostPause, IsNotAFaultOfTheLidar) {
  for (const std::int64_t pause_ms : {50, 300, 1000}) {
    for (std::int64_t at_ms = 350; at_ms < 9'000; at_ms += 331) {
      sim::device simulated(sim::built_in_world(), {});
      sim::virtual_clock clock;
      const examined done =
          examine(simulated, clock, {}, wrap_in<paused_host>(&clock, at_ms * ms, pause_ms * ms));
      const std::string found = done.diagnoses();
      if (pause_ms == 50) {
        EXPECT_EQ(found, "") << at_ms << done;
      } else {
        EXPECT_TRUE(found.empty() || found == "host_busy") << pause_ms << " at " << at_ms << done;
      }
      EXPECT_NEAR(number_of(done, diagnostic_stage::rate, "measured_hz"), 7.0, 0.07) << at_ms;
      EXPECT_NEAR(number_of(done, diagnostic_stage::rate, "sample_rate_hz"), 9000.0, 45.0) << at_ms;
      EXPECT_EQ(number_of(done, diagnostic_stage::loss, "samples_lost"), 0.0) << at_ms << done;
    }
  }
}

/// Before, at and after the begin of a measurement, with the buffer of a pseudo-terminal.
TEST(HostPause, IsTheCauseOfWhatItsFullBufferLoses) {
  for (const std::int64_t pause_ms : {300, 800}) {
    for (std::int64_t at_ms = 2'000; at_ms < 6'000; at_ms += 37) {
      sim::device simulated(sim::built_in_world(), {});
      sim::virtual_clock clock;
      diagnostic_options how;
      how.measuring_time = std::chrono::milliseconds(500);
      const examined done = examine(
          simulated, clock, how, wrap_in<paused_host>(&clock, at_ms * ms, pause_ms * ms, 4'096U));
      const std::string found = done.diagnoses();
      EXPECT_TRUE(found.empty() || found == "host_busy") << pause_ms << " at " << at_ms << done;
    }
  }
}

TEST(HostPause, LongPauseDuringTheScan_IsReported) {
  for (const std::int64_t pause_ms : {300, 1000}) {
    sim::device simulated(sim::built_in_world(), {});
    sim::virtual_clock clock;
    const examined done =
        examine(simulated, clock, {}, wrap_in<paused_host>(&clock, 5'000 * ms, pause_ms * ms));
    EXPECT_EQ(done.diagnoses(), "host_busy");
    EXPECT_FALSE(done.fails());
    const double longest_ms = number_of(done, diagnostic_stage::stream, "longest_host_pause_ms");
    EXPECT_GE(longest_ms, static_cast<double>(pause_ms));
    EXPECT_LE(longest_ms, static_cast<double>(pause_ms + 50));
  }
}

/// The pauses of a busy computer look like faults of the lidar and of the connection: one cause is given.
TEST(HostPause, IsTheOnlyCauseGiven) {
  const auto found = [](std::initializer_list<std::string_view> faults) {
    sim::device simulated(sim::built_in_world(), {}, faults_of(faults));
    sim::virtual_clock clock;
    return examine(simulated, clock, {}, wrap_in<paused_host>(&clock, 5'000 * ms, 300 * ms))
        .diagnoses();
  };
  EXPECT_EQ(found({"stall@6s+300ms"}), "host_busy");
  EXPECT_EQ(found({"stall@6s+900ms"}), "host_busy");
  EXPECT_EQ(found({"batch@5s+100s"}), "host_busy");
  EXPECT_EQ(found({"flip"}), "host_busy bits_flipped") << "damage is no matter of time";
}

TEST(HostPause, DuringTheQueriesExplainsAFewLateReplies) {
  int busy = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    sim::device_options options;
    options.scanner.seed = seed;
    sim::device simulated(sim::built_in_world(), options, faults_of({"late=200ms*0.12"}));
    sim::virtual_clock clock;
    const examined done =
        examine(simulated, clock, {}, wrap_in<paused_host>(&clock, 300 * ms, 300 * ms));
    EXPECT_THAT(done.diagnoses(), testing::Not(testing::HasSubstr("answers_late"))) << seed << done;
    busy += done.diagnoses() == "host_busy" ? 1 : 0;
  }
  EXPECT_GT(busy, 10);
  EXPECT_EQ(examine({}, faults_of({"late=200ms"})).diagnoses(), "answers_late");
}

// A device that is silent itself is not a busy host.
TEST(HostPause, IsNotAStall) {
  EXPECT_EQ(examine({}, faults_of({"stall@4s+300ms"})).diagnoses(), "stalls");
}

TEST(LateRest, OfAPacketIsNotAScanThatContinues) {
  sim::device simulated(sim::built_in_world(), {});
  sim::virtual_clock clock;
  const examined done = examine(simulated, clock, {}, wrap_in<link_with_a_late_rest>());
  EXPECT_EQ(done.diagnoses(), "") << done;
}

TEST(SpinningUp, IsWaitedForAndReported) {
  for (const std::int64_t silence_ms : {100, 1'500, 2'500, 9'000}) {
    sim::device_options options;
    options.silence_ns = silence_ms * ms;
    const examined done = examine(options);
    EXPECT_EQ(done.diagnoses(), "") << silence_ms << done;
    const bool is_reported = std::count(done.activities.begin(), done.activities.end(),
                                        diagnostic_activity::spinning_up) == 1;
    EXPECT_EQ(is_reported, silence_ms > 500) << silence_ms;
    const double first_ms = number_of(done, diagnostic_stage::motor, "first_packet_ms");
    EXPECT_GE(first_ms, static_cast<double>(silence_ms));
    EXPECT_LT(first_ms, static_cast<double>(silence_ms + 300));
  }
}

}  // namespace
