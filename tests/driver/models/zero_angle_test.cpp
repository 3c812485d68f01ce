// SPDX-License-Identifier: MIT
// The offset of zero of a live lidar: 180 degrees, a silent or damaged answer to 93, and what the user gives.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "model_bench.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using test::bench;
using test::options_of;

constexpr std::int64_t second = 1'000'000'000;

/// The points of the third scan, and the events until then.
struct heard {
  std::vector<point> points;
  std::vector<lidar_event::kind> events;

  [[nodiscard]] bool lacks_zero() const {
    return std::ranges::find(events, lidar_event::kind::no_zero_angle) != events.end();
  }
};

heard third_scan(lidar& of) {
  heard all;
  const auto started = of.start();
  EXPECT_TRUE(started) << started.error().message();
  for (int i = 0; i < 3; ++i) {
    const auto scan = of.wait_scan(3000ms);
    EXPECT_TRUE(scan) << scan.error().message();
    if (scan) all.points.assign(scan->points.begin(), scan->points.end());
  }
  while (const auto event = of.next_event()) all.events.push_back(event->what);
  return all;
}

/// By how many degrees, from -180 to 179, `points` are turned from `wanted`: where the ranges of both fit best.
int turned_deg(const std::vector<point>& wanted, const std::vector<point>& points) {
  const auto ranges_of = [](const std::vector<point>& from) {
    std::array<double, 360> all{};
    for (const point& each : from) {
      all[static_cast<std::size_t>(each.angle_deg) % 360] = static_cast<double>(each.range_mm);
    }
    return all;
  };
  const auto a = ranges_of(wanted);
  const auto b = ranges_of(points);
  int best = 999;
  double least = 1e12;
  for (int shift = -180; shift < 180; ++shift) {
    double off = 0.0;
    for (int i = 0; i < 360; ++i) {
      const auto at = static_cast<std::size_t>((i + shift + 360) % 360);
      off += std::min(std::abs(a[static_cast<std::size_t>(i)] - b[at]), 1000.0);
    }
    if (off >= least) continue;
    least = off;
    best = shift;
  }
  return best;
}

/// Not turned, but for the rounding to whole degrees.
bool is_alike(const std::vector<point>& wanted, const std::vector<point>& points) {
  return std::abs(turned_deg(wanted, points)) <= 1;
}

sim::device_options turned(std::string_view word, std::int32_t cdeg) {
  sim::device_options options = options_of(*model_named(word));
  options.zero_angle_cdeg = cdeg;
  options.scanner.noise_mm = options.scanner.noise_ratio = 0;
  options.scanner.dropout_ratio = 0;
  return options;
}

std::vector<sim::fault> faults(std::initializer_list<std::string_view> texts) {
  std::vector<sim::fault> all;
  for (const std::string_view text : texts) {
    all.push_back(std::get<sim::fault>(sim::parse_fault(text)));
  }
  return all;
}

class LiveZeroAngle : public testing::TestWithParam<const char*> {
 protected:
  const model& which_ = *model_named(GetParam());
};

// The device measures in the same directions, and sends angles that are too small by its offset.
TEST_P(LiveZeroAngle, EachOffsetIsAdded) {
  std::vector<point> wanted;
  for (const std::int32_t cdeg : {0, 18'000, -18'000, 9'000, -7'375, 36'000}) {
    bench on(which_, turned(GetParam(), cdeg));
    auto lidar = on.open();
    ASSERT_TRUE(lidar) << lidar.error().message();
    const heard got = third_scan(*lidar);
    EXPECT_FALSE(got.lacks_zero()) << cdeg;
    if (cdeg == 0) wanted = got.points;
    EXPECT_TRUE(is_alike(wanted, got.points)) << cdeg;
  }
}

TEST_P(LiveZeroAngle, WithoutAnAnswer_IsReportedAndAskedAgain) {
  for (const std::string_view text : {"mute=93@0+20s", "wrong=93@0+20s"}) {
    bench plain(which_, turned(GetParam(), 0));
    auto usual = plain.open();
    ASSERT_TRUE(usual);
    const std::vector<point> wanted = third_scan(*usual).points;

    bench on(which_, turned(GetParam(), 9'000), faults({text}));
    auto lidar = on.open();
    ASSERT_TRUE(lidar) << lidar.error().message();
    const heard first = third_scan(*lidar);
    EXPECT_TRUE(first.lacks_zero()) << text;
    EXPECT_NEAR(turned_deg(wanted, first.points), -90, 1) << text;
    EXPECT_TRUE(lidar->stop());
    const heard second_start = third_scan(*lidar);
    EXPECT_TRUE(second_start.lacks_zero()) << "at each start, " << text;
    EXPECT_TRUE(lidar->stop());
    on.clock.advance_to(21 * second);
    const heard later = third_scan(*lidar);
    EXPECT_FALSE(later.lacks_zero()) << text;
    EXPECT_TRUE(is_alike(wanted, later.points)) << text;
  }
}

TEST_P(LiveZeroAngle, AfterAReconnect_IsAskedAgain) {
  bench on(which_, turned(GetParam(), 9'000), faults({"mute=93@0+10s", "unplug@20s+1s"}));
  auto lidar = on.open({.reconnect = true});
  ASSERT_TRUE(lidar);
  EXPECT_TRUE(third_scan(*lidar).lacks_zero());
  std::vector<lidar_event::kind> events;
  std::vector<point> last;
  while (on.clock.now_ns() < 30 * second) {
    const auto scan = lidar->try_scan(500ms);
    ASSERT_TRUE(scan || !scan.error().is_fatal()) << scan.error().message();
    if (scan && !scan->is_piece()) last.assign(scan->points.begin(), scan->points.end());
    while (const auto event = lidar->next_event()) events.push_back(event->what);
  }
  EXPECT_EQ(std::ranges::count(events, lidar_event::kind::reconnected), 1);
  EXPECT_EQ(std::ranges::count(events, lidar_event::kind::no_zero_angle), 0);
  bench plain(which_, turned(GetParam(), 0));
  auto usual = plain.open();
  EXPECT_TRUE(is_alike(third_scan(*usual).points, last));
}

TEST_P(LiveZeroAngle, ThatIsKnown_StaysWhenALaterAnswerIsMissing) {
  bench on(which_, turned(GetParam(), 9'000), faults({"mute=93@6s"}));
  auto lidar = on.open();
  ASSERT_TRUE(lidar);
  const heard first = third_scan(*lidar);
  EXPECT_TRUE(lidar->stop());
  on.clock.advance_to(7 * second);
  const heard again = third_scan(*lidar);
  EXPECT_FALSE(again.lacks_zero());
  EXPECT_TRUE(is_alike(first.points, again.points));
}

TEST_P(LiveZeroAngle, ThatIsGiven_IsNotAsked) {
  bench on(which_, turned(GetParam(), 9'000));
  auto lidar = on.open({.zero_angle = zero_angle{9'000}});
  ASSERT_TRUE(lidar);
  const heard got = third_scan(*lidar);
  EXPECT_FALSE(got.lacks_zero());
  EXPECT_TRUE(
      std::ranges::none_of(on.device.log(), [](const auto& each) { return each.code == 0x93; }));
  bench plain(which_, turned(GetParam(), 0));
  auto usual = plain.open();
  EXPECT_TRUE(is_alike(third_scan(*usual).points, got.points));
}

INSTANTIATE_TEST_SUITE_P(Models, LiveZeroAngle,
                         testing::Values("g1", "g2", "g2a", "g2c", "r2", "tg15", "tg30", "tg50"),
                         [](const auto& each) { return std::string(each.param); });

TEST(LiveZeroAngles, OfOtherModels_NothingIsMissing) {
  for (const std::string_view word : {"g4", "x4", "t-mini-pro", "x2"}) {
    bench on(*model_named(word));
    auto lidar = on.open();
    ASSERT_TRUE(lidar);
    EXPECT_FALSE(third_scan(*lidar).lacks_zero()) << word;
    const auto refused = on.open({.zero_angle = zero_angle{100}});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code(), problem::not_supported) << word;
  }
}

}  // namespace
}  // namespace g4lidar
