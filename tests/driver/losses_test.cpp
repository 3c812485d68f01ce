// SPDX-License-Identifier: MIT
// When a scan ends by itself, decoded points are delivered before the error.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "driver/live/setup_sequence.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/lidar.hpp"
#include "support/virtual_transport.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using test::open_virtual;
using test::virtual_bench;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t second = 1'000 * ms;

/// The points of next_points() until a fatal error, or until `end_ns` if there is none.
std::uint64_t points_of(lidar& device, const virtual_bench& bench, std::int64_t end_ns) {
  std::uint64_t points = 0;
  while (bench.now_ns < end_ns) {
    const auto some = device.next_points(500ms);
    if (some) points += some->size();
    if (!some && some.error().is_fatal()) break;
  }
  return points;
}

struct ended_scan {
  std::vector<sim::fault> faults;
  bool reconnect = false;
};

class Losses : public testing::TestWithParam<ended_scan> {};

TEST_P(Losses, EveryPointOfTheRing_IsDelivered) {
  for (int shift_ms = 0; shift_ms < 40; shift_ms += 3) {
    virtual_bench bench({}, GetParam().faults);
    bench.now_ns += shift_ms * ms;  // the fault occurs at another place
    lidar_options options;
    options.reconnect = GetParam().reconnect;
    auto device = open_virtual(bench, options);
    ASSERT_TRUE(device);
    ASSERT_TRUE(device->start());
    const std::uint64_t points = points_of(*device, bench, 9 * second);
    ASSERT_GT(points, 10'000U);
    EXPECT_EQ(points + device->counts().points_missed, device->counts().stream.points) << shift_ms;
    EXPECT_EQ(device->counts().points_missed, 0U);
  }
}

TEST_P(Losses, EveryPointOfTheRing_IsInAScanOrAPiece) {
  virtual_bench bench({}, GetParam().faults);
  lidar_options options;
  options.reconnect = GetParam().reconnect;
  options.partial_scans = true;
  auto device = open_virtual(bench, options);
  ASSERT_TRUE(device);
  ASSERT_TRUE(device->start());
  std::uint64_t points = 0;
  while (bench.now_ns < 9 * second) {
    const auto scan = device->try_scan(500ms);
    if (scan) points += scan->points.size();
    if (!scan && scan.error().is_fatal()) break;
  }
  static_cast<void>(device->stop());
  while (const auto scan = device->try_scan(0ms)) points += scan->points.size();
  EXPECT_EQ(points, device->counts().stream.points);
  EXPECT_EQ(device->counts().scans_missed, 0U);
}

const sim::fault unplug = sim::make_fault(sim::fault_kind::unplug, 4 * second, 1 * second);
const sim::fault stall = sim::make_fault(sim::fault_kind::stall, 4 * second);

INSTANTIATE_TEST_SUITE_P(All, Losses,
                         testing::Values(ended_scan{{}, false}, ended_scan{{unplug}, false},
                                         ended_scan{{unplug}, true}, ended_scan{{stall}, false}));

TEST(Losses, PointsOfAClosedLidar_AreCounted) {
  virtual_bench bench;
  auto device = open_virtual(bench);
  ASSERT_TRUE(device);
  ASSERT_TRUE(device->start());
  std::uint64_t points = points_of(*device, bench, 4 * second);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(device->try_scan(500ms));
  ASSERT_TRUE(device->close());
  EXPECT_EQ(device->next_points(0ms).error().code(), problem::gone);
  EXPECT_EQ(points + device->counts().points_missed, device->counts().stream.points);
  EXPECT_GT(device->counts().points_missed, 0U);
}

TEST(Losses, FileOfBytes_IsDeliveredCompletely) {
  virtual_bench bench;
  std::vector<std::uint8_t> stream;
  {
    const std::string path = testing::TempDir() + "g4lidar-losses.bin";
    sim::device simulated(sim::built_in_world());
    simulated.write(encode(command::start), 0);
    std::vector<std::uint8_t> buffer(4096);
    for (std::int64_t now_ns = 0; now_ns < 3 * second; now_ns += ms) {
      const std::size_t count = simulated.read(buffer, now_ns);
      stream.insert(stream.end(), buffer.begin(), buffer.begin() + static_cast<long>(count));
    }
    std::FILE* const file = std::fopen(path.c_str(), "wb");
    ASSERT_NE(file, nullptr);
    std::fwrite(stream.data(), 1, stream.size(), file);
    std::fclose(file);
    auto device = lidar::open("file:" + path);
    ASSERT_TRUE(device) << device.error().message();
    ASSERT_TRUE(device->start());
    std::uint64_t points = 0;
    result<std::span<const point>> some = device->next_points(500ms);
    for (; some; some = device->next_points(500ms)) points += some->size();
    EXPECT_EQ(some.error().code(), problem::end_of_input);
    EXPECT_EQ(points, device->counts().stream.points);
    EXPECT_GT(points, 10'000U);

    lidar_options options;
    options.device = "file:" + path;
    options.partial_scans = true;
    auto again = lidar::open(options);
    ASSERT_TRUE(again) << again.error().message();
    ASSERT_TRUE(again->start());
    std::uint64_t in_scans = 0;
    result<scan> scan = again->try_scan(500ms);
    for (; scan; scan = again->try_scan(500ms)) in_scans += scan->size();
    EXPECT_EQ(scan.error().code(), problem::end_of_input);
    EXPECT_EQ(in_scans, points);
    EXPECT_EQ(in_scans, again->counts().stream.points);
    EXPECT_EQ(again->counts().scans_missed, 0U);
    std::remove(path.c_str());
  }
}

TEST(Losses, WaitingCall_ReturnsImmediately_NextWaitsForTheReconnect) {
  virtual_bench bench({}, std::vector{unplug});
  lidar_options options;
  options.reconnect = true;
  auto device = open_virtual(bench, options);
  ASSERT_TRUE(device);
  ASSERT_TRUE(device->start());
  result<scan> got = device->try_scan(2000ms);
  while (got) got = device->try_scan(2000ms);
  EXPECT_EQ(got.error().code(), problem::reconnecting);
  EXPECT_FALSE(got.error().is_fatal());
  EXPECT_LT(bench.now_ns, 4 * second + 100 * ms);
  EXPECT_EQ(device->ask(requests::health()).error().code(), problem::reconnecting);
  EXPECT_EQ(device->start().error().code(), problem::reconnecting);
  EXPECT_TRUE(device->try_scan(20'000ms)) << "the lidar is back after a second";
  EXPECT_GT(bench.now_ns, 5 * second);
}

TEST(Losses, LongestAndShortestTimeout_AreAccepted) {
  virtual_bench bench;
  auto device = open_virtual(bench);
  ASSERT_TRUE(device);
  ASSERT_TRUE(device->start());
  EXPECT_TRUE(device->try_scan(std::chrono::milliseconds::max()));
  const std::int64_t before_ns = bench.now_ns;
  EXPECT_EQ(device->try_scan(std::chrono::milliseconds::min()).error().code(), problem::timeout);
  EXPECT_EQ(device->next_points(std::chrono::milliseconds::min()).has_value(), true);
  EXPECT_LT(bench.now_ns - before_ns, 10 * ms);
}

TEST(Saturating, Sum_EndsAtTheLastTime) {
  using detail::saturating_add;
  using detail::saturating_sub;
  constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
  constexpr std::int64_t least = std::numeric_limits<std::int64_t>::min();
  static_assert(saturating_add(most, 1) == most && saturating_add(least, -1) == least);
  static_assert(saturating_sub(most, -1) == most && saturating_sub(least, 1) == least);
  static_assert(saturating_sub(0, least) == most && saturating_add(least, most) == -1);
  static_assert(saturating_add(40, 2) == 42 && saturating_sub(40, -2) == 42);
  static_assert(detail::saturated<std::int64_t>(1e300) == most &&
                detail::saturated<std::int64_t>(-1e300) == least);
  static_assert(detail::saturated<std::int64_t>(std::numeric_limits<double>::quiet_NaN()) == 0);
  EXPECT_EQ(detail::saturated<std::int64_t>(42.9), 42);
}

/// Every step at once: a bounded list would drop some of them.
TEST(SetupSequence, RepeatedSteps_NeverOverflow) {
  lidar_options all;
  all.sample_rate = sample_rate::khz_9;
  all.frequency = scan_frequency{700};
  all.direction = motor_direction::clockwise;
  all.constant = constant_frequency::on;
  all.idle = low_power::on;
  all.protection = power_down_protection::on;
  setup_sequence sequence;
  for (int i = 0; i < 20; ++i) {
    sequence.add_start(all);
    sequence.add(setup_step::stop);
    sequence.add(setup_step::identify);
  }
  std::vector<request_kind> asked;
  for (; !sequence.is_done(); sequence.finish_next()) {
    asked.push_back(request_of(sequence.next(), all).what);
  }
  const std::vector wanted{request_kind::device_info,
                           request_kind::stop,
                           request_kind::health,
                           request_kind::set_sample_rate,
                           request_kind::set_scan_frequency,
                           request_kind::set_direction,
                           request_kind::set_constant_frequency,
                           request_kind::set_low_power,
                           request_kind::set_protection,
                           request_kind::start};
  EXPECT_EQ(asked, wanted);
}

TEST(SetupSequence, NoOptions_QueriesHealthAndSampleRateOnly) {
  setup_sequence sequence;
  sequence.add_start({});
  std::vector<request_kind> asked;
  for (; !sequence.is_done(); sequence.finish_next()) {
    asked.push_back(request_of(sequence.next(), {}).what);
  }
  EXPECT_EQ(asked, (std::vector{request_kind::health, request_kind::get_sample_rate,
                                request_kind::start}));
  EXPECT_FALSE(is_needed(setup_step::sample_rate, {}));
  EXPECT_FALSE(is_needed(setup_step::health, {}));
  EXPECT_TRUE(is_needed(setup_step::start, {}));
}

}  // namespace
}  // namespace g4lidar
