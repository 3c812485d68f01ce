// SPDX-License-Identifier: MIT
// The reader with a thread of its own.
#include "g4lidar/background_reader.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>
#include <vector>

#include "support/virtual_line.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using test::open_virtual;
using test::virtual_bench;

constexpr std::int64_t ms = 1'000'000;

/// Waits for something that happens in the other thread; false if it does not within 20 s.
template <class Condition>
bool comes_true(Condition&& condition) {
  const auto end = std::chrono::steady_clock::now() + 20s;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(1ms);
  }
  return true;
}

TEST(BackgroundReader, FeedsTheRing) {
  virtual_bench bench;
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  auto reader = background_reader::start(std::move(*lidar));
  ASSERT_TRUE(reader) << reader.error().message();
  auto points = reader->points().make_reader();
  std::vector<point> some(4096);
  std::uint64_t seen = 0;
  EXPECT_TRUE(comes_true([&] {
    const ring_read read = points.read(some);
    seen += read.points + read.missed;
    return seen > 50'000;
  }));
  EXPECT_TRUE(comes_true([&] { return reader->counts().scans > 10; }));
  reader->stop();
  EXPECT_FALSE(reader->failed());
  EXPECT_TRUE(bench.device.is_idle_and_silent(bench.now_ns));
  reader->stop();  // again: nothing
}

TEST(BackgroundReader, IsDestroyedAtAnyMoment) {
  for (int i = 0; i < 20; ++i) {
    virtual_bench bench;
    {
      auto lidar = open_virtual(bench);
      ASSERT_TRUE(lidar);
      auto reader = background_reader::start(std::move(*lidar));
      ASSERT_TRUE(reader);
      std::this_thread::sleep_for(std::chrono::microseconds(100 * i));
      background_reader moved = std::move(*reader);
      *reader = std::move(moved);
    }
    EXPECT_TRUE(bench.device.is_idle_and_silent(bench.now_ns)) << i;
  }
}

TEST(BackgroundReader, TellsWhyItEnded) {
  const sim::fault faults[] = {sim::make_fault(sim::fault_kind::unplug, 4000 * ms)};
  virtual_bench bench({}, faults);
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  auto reader = background_reader::start(std::move(*lidar));
  ASSERT_TRUE(reader);
  ASSERT_TRUE(comes_true([&] { return reader->failed().has_value(); }));
  EXPECT_EQ(reader->failed()->what(), problem::gone);
  const auto event = reader->next_event();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->what, lidar_event::kind::lost);
}

TEST(BackgroundReader, StopsWhileTheDeviceIsAway) {
  const sim::fault faults[] = {sim::make_fault(sim::fault_kind::unplug, 4000 * ms)};
  virtual_bench bench({}, faults);
  lidar_options options;
  options.reconnect = true;
  auto lidar = open_virtual(bench, options);
  ASSERT_TRUE(lidar);
  auto reader = background_reader::start(std::move(*lidar));
  ASSERT_TRUE(reader);
  ASSERT_TRUE(comes_true([&] { return reader->next_event().has_value(); }));
  reader->stop();
  EXPECT_FALSE(reader->failed());
}

TEST(BackgroundReader, SaysWhyItCannotStart) {
  sim::device_options sick;
  sick.condition = {health_status::error, 7};
  virtual_bench bench(sick);
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  const auto reader = background_reader::start(std::move(*lidar));
  ASSERT_FALSE(reader);
  EXPECT_EQ(reader.error().what(), problem::unhealthy);
}

}  // namespace
}  // namespace g4lidar
