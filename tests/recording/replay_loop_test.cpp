// SPDX-License-Identifier: MIT
// A loop over the scans of a recording that is played in its time waits where the loop over the
// recorded lidar did.
#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "recorded_run.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;
constexpr std::int64_t second = 1'000'000'000;

TEST(ReplayLoop, RecordedSpinUpAndUnplug_DoNotEndIt) {
  const temporary_path path;
  int recorded_scans = 0;
  {
    sim::device_options device;
    device.silence_ns = 4 * second;
    const sim::fault unplug = sim::make_fault(sim::fault_kind::unplug, 9 * second, 10 * second);
    virtual_bench bench(device, {&unplug, 1});
    auto writer = recording_writer::create(path.text());
    ASSERT_TRUE(writer);
    auto tapped = recorded(std::make_unique<virtual_connector>(bench), *writer);
    ASSERT_TRUE(tapped);
    lidar_options options;
    options.reconnect = true;
    auto lidar = lidar::open(std::move(*tapped), options);
    ASSERT_TRUE(lidar);
    ASSERT_TRUE(lidar->start());
    for ([[maybe_unused]] const scan& each : lidar->scans(300ms)) {
      if (++recorded_scans == 60) break;
    }
    EXPECT_EQ(lidar->counts().reconnects, 1U);
    ASSERT_TRUE(lidar->close());
    ASSERT_TRUE(writer->close());
  }
  EXPECT_EQ(recorded_scans, 60);
  // 0.05 s are 2 s of the recording: more than a revolution, less than the spin-up and the unplug.
  auto from = replay::open(path.text(), {.speed = 40.0});
  ASSERT_TRUE(from);
  auto lidar = lidar::open(std::move(*from));
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->start());
  auto scans = lidar->scans(50ms);
  int played = 0;
  for ([[maybe_unused]] const scan& each : scans) ++played;
  EXPECT_EQ(*scans.why_ended(), problem::end_of_input) << scans.why_ended()->message();
  EXPECT_GE(played, recorded_scans);
}

}  // namespace
}  // namespace g4lidar::test
