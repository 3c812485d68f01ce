// SPDX-License-Identifier: MIT
// A program that takes only whole scans is woken for whole scans: what that saves, and that it loses nothing.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "pace_bench.hpp"
#include "support/measured_truth.hpp"

namespace g4lidar {
namespace {

using namespace test;

struct setup {
  g4lidar::sample_rate sample_rate = g4lidar::sample_rate::khz_9;
  scan_frequency frequency{700};
};

lidar start_with(test::virtual_bench& bench, const setup& wanted) {
  lidar_options options;
  options.sample_rate = wanted.sample_rate;
  options.frequency = wanted.frequency;
  auto opened = test::open_virtual(bench, options);
  EXPECT_TRUE(opened);
  EXPECT_TRUE(opened->start());
  return std::move(*opened);
}

/// When each scan was handed over, for so long.
std::vector<std::int64_t> read_scans(lidar& device, test::virtual_bench& bench,
                                     std::int64_t for_ns) {
  std::vector<std::int64_t> times;
  const std::int64_t end_ns = bench.now_ns + for_ns;
  while (bench.now_ns < end_ns) {
    if (device.try_scan(500ms)) times.push_back(bench.now_ns);
  }
  return times;
}

/// How much later each of `times` is than that of the same scan in `others`; sorted.
std::vector<std::int64_t> later(const std::vector<std::int64_t>& times,
                                const std::vector<std::int64_t>& others) {
  std::vector<std::int64_t> found;
  for (const std::int64_t time : times) {
    std::int64_t least = 30 * ms;
    for (const std::int64_t other : others) {
      if (std::abs(time - other) < std::abs(least)) least = time - other;
    }
    found.push_back(least);
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::int64_t percentile(const std::vector<std::int64_t>& sorted, std::size_t p) {
  return sorted[sorted.size() * p / 100];
}

class ScanPace : public testing::TestWithParam<setup> {};

TEST_P(ScanPace, NeverLeavesMoreThanHalfOfWhatTheSystemKeeps) {
  test::virtual_bench bench;
  lidar device = start_with(bench, GetParam());
  static_cast<void>(read_scans(device, bench, 4 * second));
  bench.largest_read = 0;
  const auto scans = read_scans(device, bench, 20 * second);
  EXPECT_LE(bench.largest_read, 4095U / 2 + 20);  // and what comes during one call
  EXPECT_GT(bench.largest_read, 500U);            // it did sleep
  EXPECT_EQ(device.counts().samples_lost, 0U);
  EXPECT_GT(scans.size(), 90U);
}

TEST_P(ScanPace, HandsScansOverAsSoonAsAtThePaceOfPackets) {
  std::vector<std::int64_t> times[2];
  for (const bool takes_points : {false, true}) {
    test::virtual_bench bench;
    lidar device = start_with(bench, GetParam());
    if (takes_points) static_cast<void>(device.points());
    static_cast<void>(read_scans(device, bench, 4 * second));
    times[takes_points ? 1 : 0] = read_scans(device, bench, 30 * second);
  }
  const auto delays = later(times[0], times[1]);
  EXPECT_LE(percentile(delays, 50), 50 * us);
  EXPECT_LE(percentile(delays, 98), 200 * us);
}

INSTANTIATE_TEST_SUITE_P(AtAllRates, ScanPace,
                         testing::Values(setup{}, setup{.frequency = scan_frequency{500}},
                                         setup{.frequency = scan_frequency{1200}},
                                         setup{sample_rate::khz_4, scan_frequency{500}},
                                         setup{sample_rate::khz_8, scan_frequency{1000}}));

TEST(ScanPaceOfADriver, ReadsAtMostFifteenTimesInARevolution) {
  test::virtual_bench bench;
  lidar device = start_with(bench, {});
  static_cast<void>(read_scans(device, bench, 4 * second));
  const std::uint64_t before = bench.reads + bench.pauses;
  const auto scans = read_scans(device, bench, 20 * second);
  EXPECT_LE(bench.reads + bench.pauses - before, 15 * scans.size());
}

TEST(ScanPaceOfADriver, WhoTakesPointsGetsEachPacketWhenItIsComplete) {
  test::virtual_bench bench;
  lidar device = start_with(bench, {});
  static_cast<void>(read_scans(device, bench, 4 * second));
  std::vector<std::int64_t> ages;
  for (int i = 0; i < 2000; ++i) {
    const auto points = device.next_points(500ms);
    ASSERT_TRUE(points);
    if (i >= 20) ages.push_back(bench.now_ns - points->back().time_ns);
  }
  std::sort(ages.begin(), ages.end());
  EXPECT_LT(ages[ages.size() * 99 / 100], 6 * ms);  // a packet takes 4 ms to come
}

/// A program that uses the ring in another thread may never call next_points().
TEST(ScanPaceOfADriver, WhoAsksForTheRingGetsEachPacket) {
  test::virtual_bench bench;
  lidar device = start_with(bench, {});
  static_cast<void>(device.points());
  static_cast<void>(read_scans(device, bench, 4 * second));
  bench.largest_read = 0;
  static_cast<void>(read_scans(device, bench, 4 * second));
  EXPECT_LE(bench.largest_read, 400U);
}

TEST(ScanPaceOfADriver, ATransportOfUnknownMemoryIsReadAtThePaceOfPackets) {
  test::virtual_bench bench;
  bench.kept_bytes = 0;
  lidar device = start_with(bench, {});
  static_cast<void>(read_scans(device, bench, 4 * second));
  bench.largest_read = 0;
  static_cast<void>(read_scans(device, bench, 4 * second));
  EXPECT_LE(bench.largest_read, 400U);
}

/// An event loop that follows next_deadline() waits for no bytes in between.
TEST(ScanPaceOfADriver, AnEventLoopIsWokenForScansToo) {
  test::virtual_bench bench;
  lidar device = start_with(bench, {});
  const auto turns_for = [&](std::int64_t for_ns, std::uint64_t& scans) {
    std::uint64_t turns = 0;
    const std::int64_t end_ns = bench.now_ns + for_ns;
    while (bench.now_ns < end_ns) {
      while (device.try_scan(0ms)) ++scans;
      const std::int64_t due_ns = device.event_loop().next_deadline_ns();
      const bool rests = due_ns < bench.now_ns + 100 * ms && due_ns > bench.now_ns;
      bench.now_ns =
          rests ? due_ns : std::max(bench.now_ns + 1, bench.device.next_ns(bench.now_ns));
      ++turns;
    }
    return turns;
  };
  std::uint64_t scans = 0;
  static_cast<void>(turns_for(4 * second, scans));
  scans = 0;
  const std::uint64_t turns = turns_for(20 * second, scans);
  EXPECT_GT(scans, 135U);
  EXPECT_LE(turns, 15 * scans);
  EXPECT_EQ(device.counts().samples_lost, 0U);
}

/// What breaks the forecast of the end costs no byte, and no scan is much later for it.
class ScanPaceWith : public testing::TestWithParam<const char*> {};

TEST_P(ScanPaceWith, LosesNothingToTheSleep) {
  std::uint64_t points[2];
  std::uint64_t scans[2];
  std::vector<std::int64_t> times[2];
  for (const bool takes_points : {false, true}) {
    const auto trouble = std::get<sim::fault>(sim::parse_fault(GetParam()));
    test::virtual_bench bench({}, {&trouble, 1});
    lidar device = start_with(bench, {});
    if (takes_points) static_cast<void>(device.points());
    const std::size_t i = takes_points ? 1 : 0;
    times[i] = read_scans(device, bench, 40 * second - bench.now_ns);
    points[i] = device.counts().stream.points;
    scans[i] = device.counts().scans;
  }
  // What the last reading brings.
  EXPECT_NEAR(static_cast<double>(points[0]), static_cast<double>(points[1]), 900.0);
  EXPECT_NEAR(static_cast<double>(scans[0]), static_cast<double>(scans[1]), 1.0);
  const auto delays = later(times[0], times[1]);
  EXPECT_LE(percentile(delays, 50), 100 * us);
  EXPECT_LE(percentile(delays, 95), 2 * ms);
}

INSTANTIATE_TEST_SUITE_P(Faults, ScanPaceWith,
                         testing::Values("flip*0.0001", "drop*0.001", "truncate*0.01", "jolt*0.01",
                                         "stall@10s+400ms", "batch=1ms", "batch=4ms",
                                         "batch=16ms"));

/// The clock gets few arrivals at this pace, and with a bridge that holds bytes back each of them may be late.
class ScanPaceTimes : public testing::TestWithParam<const char*> {};

TEST_P(ScanPaceTimes, AreWithinAMillisecondOfTheTruth) {
  std::vector<sim::fault> faults;
  if (*GetParam() != '\0') faults.push_back(std::get<sim::fault>(sim::parse_fault(GetParam())));
  sim::device_options simulated;
  simulated.truth_capacity = 500'000;
  test::virtual_bench bench(simulated, faults);
  lidar device = start_with(bench, {});
  std::vector<point> points;
  while (bench.now_ns < 40 * second) {
    const auto found = device.try_scan(500ms);
    ASSERT_TRUE(found) << found.error().message();
    if (bench.now_ns < 8 * second) continue;  // the clock needs 5 s from the start
    points.insert(points.end(), found->begin(), found->end());
  }
  auto truth = measured_truth::of(bench.device, simulated.truth_capacity);
  double squares = 0.0;
  for (const point& each : points) {
    const auto* const sent = truth.next(100'000, [&](const sim::sample_truth& sample) {
      return std::abs(sample.time_ns - each.time_ns) < 20 * ms &&
             looks_like(sample, static_cast<double>(each.angle_deg),
                        static_cast<double>(each.range_mm));
    });
    ASSERT_NE(sent, nullptr);
    const auto off_ns = static_cast<double>(each.time_ns - sent->time_ns);
    ASSERT_LE(std::abs(off_ns), 1e6);
    squares += off_ns * off_ns;
  }
  ASSERT_GT(points.size(), 250'000U);
  EXPECT_LE(std::sqrt(squares / static_cast<double>(points.size())), 0.2e6);
}

INSTANTIATE_TEST_SUITE_P(Bridges, ScanPaceTimes,
                         testing::Values("", "batch=1ms", "batch=4ms", "batch=16ms"));

}  // namespace
}  // namespace g4lidar
