// SPDX-License-Identifier: MIT
// Points, event loops, batches, wake-ups and the heap.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <variant>
#include <vector>

#include "g4lidar/lidar.hpp"
#include "support/allocation_count.hpp"
#include "support/virtual_transport.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using test::open_virtual;
using test::virtual_bench;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t second = 1'000 * ms;

result<lidar> open_and_start(virtual_bench& bench, const lidar_options& options = {}) {
  auto lidar = open_virtual(bench, options);
  if (!lidar) return lidar;
  if (auto started = lidar->start(); !started) return tl::unexpected(started.error());
  return lidar;
}

TEST(LidarReading, PointsComeOnceEachAndInOrder) {
  virtual_bench bench;
  auto lidar = open_and_start(bench);
  ASSERT_TRUE(lidar);
  std::uint64_t points = 0;
  std::int64_t last_ns = 0;
  const std::int64_t end = bench.now_ns + 10 * second;
  while (bench.now_ns < end) {
    const auto some = lidar->next_points(500ms);
    ASSERT_TRUE(some) << some.error().message();
    points += some->size();
    for (const point& p : *some) {
      ASSERT_GT(p.time_ns, last_ns);
      last_ns = p.time_ns;
    }
    ASSERT_LE(last_ns, bench.now_ns);
  }
  const auto counts = lidar->counts();
  EXPECT_EQ(points, counts.stream.points);
  EXPECT_EQ(counts.points_missed, 0U);
  EXPECT_NEAR(static_cast<double>(points), 9.0 * 9000, 9000);  // the motor needs time to spin up
}

TEST(LidarReading, SlowReader_GetsTheNumberOfMissedPoints) {
  virtual_bench bench;
  auto lidar = open_and_start(bench);
  ASSERT_TRUE(lidar);
  auto reader = lidar->points().make_reader();
  for (int i = 0; i < 60; ++i) ASSERT_TRUE(lidar->try_scan(2000ms));
  std::vector<point> all(std::size_t{1} << 15U);
  const ring_read read = reader.read(all);
  EXPECT_GT(read.missed, 0U);
  EXPECT_EQ(read.points + read.missed, lidar->points().written());
  const auto points = lidar->next_points(0ms);
  ASSERT_TRUE(points);
  EXPECT_EQ(lidar->counts().points_missed + points->size() + 8192, lidar->counts().stream.points);
}

TEST(LidarReading, FirstPointsAfterScans_BeginWithTheUnfinishedRevolution) {
  virtual_bench bench;
  auto lidar = open_and_start(bench);
  ASSERT_TRUE(lidar);
  std::int64_t scan_end_ns = 0;
  for (int i = 0; i < 10; ++i) {
    const auto scan = lidar->try_scan(2000ms);
    ASSERT_TRUE(scan);
    scan_end_ns = scan->points.back().time_ns;
  }
  EXPECT_EQ(lidar->counts().points_missed, 0U);  // nobody wants them
  const std::uint64_t in_scans = lidar->counts().stream.points;
  const std::int64_t half_ns = bench.now_ns + 70 * ms;
  while (bench.now_ns < half_ns) {
    bench.now_ns = std::max(bench.now_ns, bench.device.next_ns(bench.now_ns));
    ASSERT_TRUE(lidar->event_loop().process());
  }
  EXPECT_GT(lidar->counts().stream.points, in_scans + 400);
  std::uint64_t points = 0;
  std::int64_t last_ns = scan_end_ns;
  while (bench.now_ns < 5 * second) {
    const auto some = lidar->next_points(500ms);
    ASSERT_TRUE(some);
    for (const point& p : *some) {
      ASSERT_GT(p.time_ns, last_ns);
      ASSERT_LT(p.time_ns - last_ns, 200 * 1000);  // 111 us from sample to sample: none is left out
      last_ns = p.time_ns;
      ++points;
    }
  }
  const auto counts = lidar->counts();
  EXPECT_EQ(points + counts.points_missed, counts.stream.points);
  EXPECT_LE(counts.points_missed, in_scans);
}

TEST(LidarReading, PointsOfAScanThatWasNotTaken_AreReturned) {
  virtual_bench bench;
  auto lidar = open_and_start(bench);
  ASSERT_TRUE(lidar);
  while (lidar->counts().scans < 3) {
    bench.now_ns = std::max(bench.now_ns, bench.device.next_ns(bench.now_ns));
    ASSERT_TRUE(lidar->event_loop().process());
  }
  const auto some = lidar->next_points(500ms);
  ASSERT_TRUE(some);
  EXPECT_TRUE(some->front().is_revolution_start());
  EXPECT_GT(some->size(), 1200U);  // a revolution at 7 Hz
  const auto counts = lidar->counts();
  EXPECT_EQ(some->size() + counts.points_missed, counts.stream.points);
}

TEST(LidarReading, ReaderOfPoints_BeginsWithTheNextPoint) {
  virtual_bench bench;
  auto lidar = open_and_start(bench);
  ASSERT_TRUE(lidar);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(lidar->try_scan(2000ms));
  const std::uint64_t before = lidar->counts().stream.points;
  auto reader = lidar->points().make_reader();
  EXPECT_EQ(reader.ahead(), 0U);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(lidar->try_scan(2000ms));
  EXPECT_EQ(reader.ahead(), lidar->counts().stream.points - before);
}

TEST(LidarReading, EventLoop_GetsEveryScan) {
  virtual_bench bench;
  auto lidar = open_and_start(bench);
  ASSERT_TRUE(lidar);
  std::uint64_t scans = 0;
  const std::int64_t end = bench.now_ns + 10 * second;
  while (bench.now_ns < end) {
    // Like poll().
    bench.now_ns = std::max(bench.now_ns, std::min({lidar->event_loop().next_deadline_ns(),
                                                    bench.device.next_ns(bench.now_ns), end}));
    while (lidar->try_scan(0ms)) ++scans;
  }
  EXPECT_GT(scans, 60U);
  EXPECT_EQ(scans, lidar->counts().scans);
  EXPECT_EQ(lidar->counts().scans_missed, 0U);
}

TEST(LidarReading, Process_CountsScansThatWereNotTaken) {
  virtual_bench bench;
  auto lidar = open_and_start(bench);
  ASSERT_TRUE(lidar);
  const std::int64_t end = bench.now_ns + 5 * second;
  while (bench.now_ns < end) {
    bench.now_ns = std::max(bench.now_ns, std::min(bench.device.next_ns(bench.now_ns), end));
    ASSERT_TRUE(lidar->event_loop().process());
  }
  const auto counts = lidar->counts();
  EXPECT_GT(counts.scans, 25U);
  EXPECT_GE(counts.scans_missed + 1, counts.scans);
  EXPECT_LE(counts.scans_missed, counts.scans);
}

TEST(LidarReading, Batch_SavesReads) {
  const auto readings_in_10_s = [](std::chrono::milliseconds batch) {
    virtual_bench bench;
    lidar_options options;
    options.tuning.batch = batch;
    auto lidar = open_and_start(bench, options);
    EXPECT_TRUE(lidar);
    static_cast<void>(lidar->points());  // each packet is wanted
    while (bench.now_ns < 4 * second) static_cast<void>(lidar->try_scan(500ms));
    const std::uint64_t before = bench.reads + bench.pauses;
    std::uint64_t scans = 0;
    while (bench.now_ns < 14 * second) scans += lidar->try_scan(500ms).has_value();
    EXPECT_GT(scans, 65U);
    EXPECT_EQ(lidar->counts().samples_lost, 0U);
    return bench.reads + bench.pauses - before;
  };
  EXPECT_GT(readings_in_10_s(0ms), 2000U);
  EXPECT_LE(readings_in_10_s(20ms), 1100U);
}

TEST(LidarReading, Wake_EndsOneWait) {
  virtual_bench bench;
  auto lidar = open_and_start(bench);
  ASSERT_TRUE(lidar);
  lidar->wake();
  const auto woken = lidar->try_scan(2000ms);
  ASSERT_FALSE(woken);
  EXPECT_EQ(woken.error().code(), problem::cancelled);
  EXPECT_FALSE(woken.error().is_fatal());
  EXPECT_TRUE(lidar->try_scan(2000ms));
}

TEST(LidarReading, StartWokenRepeatedly_Completes) {
  virtual_bench bench;
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  bench.step_ns = 50'000;  // time passes in calls alone
  for (int i = 0; i < 100'000 && !lidar->is_scanning(); ++i) {
    lidar->wake();
    static_cast<void>(lidar->start());
  }
  ASSERT_TRUE(lidar->is_scanning());
  auto scan = lidar->try_scan(2000ms);
  if (!scan && scan.error() == problem::cancelled) scan = lidar->try_scan(2000ms);
  EXPECT_TRUE(scan) << scan.error().message();
}

class LidarReadingWith : public testing::TestWithParam<const char*> {};

TEST_P(LidarReadingWith, NothingIsAllocatedWhileItStreams) {
  std::vector<sim::fault> faults;
  if (*GetParam() != '\0') faults.push_back(std::get<sim::fault>(sim::parse_fault(GetParam())));
  virtual_bench bench({}, faults);
  auto lidar = open_and_start(bench);
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->try_scan(2000ms));
  int scans = 0;
  const std::size_t allocated = test::allocations_in([&] {
    while (bench.now_ns < 20 * second) {
      const auto scan = lidar->try_scan(500ms);
      ASSERT_TRUE(scan || !scan.error().is_fatal()) << scan.error().message();
      scans += scan.has_value();
      static_cast<void>(lidar->next_points(0ms));
      static_cast<void>(lidar->counts());
      static_cast<void>(lidar->next_event());
    }
    EXPECT_EQ(lidar->ask(requests::health()).error(), problem::scanning);
    EXPECT_EQ(lidar->set(scan_frequency::hz(10)).error(), problem::scanning);
  });
  EXPECT_EQ(allocated, 0U);
  EXPECT_GT(scans, 60);
}

INSTANTIATE_TEST_SUITE_P(Faults, LidarReadingWith,
                         testing::Values("", "flip*0.001", "drop*0.001", "truncate*0.01",
                                         "stall@5s+600ms"));

TEST(LidarReading, Scan_IsDeliveredWhenItsEndArrives) {
  virtual_bench bench;
  auto lidar = open_and_start(bench);
  ASSERT_TRUE(lidar);
  for (int i = 0; i < 20; ++i) {
    const auto scan = lidar->try_scan(2000ms);
    ASSERT_TRUE(scan);
    // The transmission of the last packet takes 4 ms, of the next zero packet 0.5, and the bridge
    // up to 1. The packet behind that, which is not waited for, would take 4 more.
    EXPECT_LT(bench.now_ns - scan->points.back().time_ns, 7 * ms);
  }
}

}  // namespace
}  // namespace g4lidar
