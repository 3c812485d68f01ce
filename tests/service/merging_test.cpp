// SPDX-License-Identifier: MIT
// Several lidars as one: where their points are, which lidar each is of, and what happens without one.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numbers>
#include <optional>

#include "service_bench.hpp"

namespace g4lidar::test {
namespace {

using ::testing::HasSubstr;

constexpr double degree = std::numbers::pi / 180;
const mounting front{{0.3, 0.1, 20 * degree}, false};
const mounting rear{{-0.4, -0.2, -150 * degree}, false};

class ServiceMerging : public Service {
 protected:
  /// Both in the same room, on a robot with the path of `way`.
  lidar_service& begin_both(service_options options = {}, const std::string& front_more = "",
                            const std::string& way = "lidar 0 0 0\n") {
    const std::string both = std::string(room) + way;
    const std::string at_front = text_file("front.txt", both + "mount 0.3,0.1,20\n");
    const std::string at_rear = text_file("rear.txt", both + "mount -0.4,-0.2,-150\n");
    service_lidar first = lidar_at("sim:?world=" + at_front + front_more, "front", front);
    first.options.reconnect = true;
    return begin({first, lidar_at("sim:?seed=9&world=" + at_rear, "rear", rear)},
                 std::move(options));
  }
  /// The next one with points of both, or with points of the second one only.
  bool wait_for_scan(bool has_first) {
    const std::size_t before = heard.number_of_scans();
    return heard.wait([&] {
      if (heard.scans.size() <= before) return false;
      const auto& counts = heard.scans.back().kept_of_each;
      return counts.size() == 2 && (counts[0] > 800) == has_first && counts[1] > 800;
    });
  }
};

TEST_F(ServiceMerging, PointsAreInTheFrameOfTheRobot) {
  begin_both();
  ASSERT_TRUE(wait_for_scan(true));
  service->stop();
  const seen_scan& last = heard.scans.back();
  ASSERT_EQ(last.kept_of_each[0] + last.kept_of_each[1], last.kept.size());
  EXPECT_LT(most_of(distances_to_walls(last.kept, {})), 0.05);
  EXPECT_FALSE(last.about.place);
  EXPECT_EQ(service->size(), 2U);
  // The points of each are around it, clockwise.
  for (std::size_t lidar = 0, from = 0; lidar < 2; from += last.kept_of_each[lidar++]) {
    const pose_2d at = lidar == 0 ? front.pose : rear.pose;
    std::size_t back = 0;
    double before = 0;
    for (std::size_t i = from; i < from + last.kept_of_each[lidar]; ++i) {
      const xy_point place = to_xy(last.kept[i], frame::robot);
      const double bearing = std::atan2(static_cast<double>(place.y_m) - at.y_m,
                                        static_cast<double>(place.x_m) - at.x_m);
      if (i > from && std::remainder(bearing - before, 2 * std::numbers::pi) > 0.0005) ++back;
      before = bearing;
    }
    EXPECT_LT(back, 20U) << lidar;
  }
}

TEST_F(ServiceMerging, OfOneLidar_PointsAreInTheFrameOfTheRobot) {
  const std::string at =
      text_file("one.txt", std::string(room) + "lidar 0 0 0\nmount 0.3,0.1,20\n");
  begin({lidar_at("sim:?world=" + at, "front", front)}, {.merges = true});
  ASSERT_TRUE(heard.wait_for_scans(2));
  service->stop();
  const seen_scan& last = heard.scans.back();
  EXPECT_EQ(last.kept_of_each, std::vector<std::size_t>{last.kept.size()});
  EXPECT_LT(most_of(distances_to_walls(last.kept, {})), 0.05);
}

TEST_F(ServiceMerging, WithoutOneOfThem_TheOtherIsGiven_AndAWarning) {
  begin_both({}, "&fault=unplug@12s");
  ASSERT_TRUE(wait_for_scan(true));
  const auto wall = std::chrono::system_clock::now().time_since_epoch();
  ASSERT_TRUE(wait_for_scan(false));
  ASSERT_TRUE(comes_true([&] { return service->status(0).state == reader_state::lost; }));
  const std::size_t before = heard.number_of_scans();
  std::vector<point> last;  // on a busy machine a scan may have no points
  ASSERT_TRUE(heard.wait([&] {
    last = heard.scans.back().kept;
    return heard.scans.size() > before + 1 && heard.scans.back().kept_of_each[0] == 0 &&
           !last.empty();
  }));
  EXPECT_EQ(service->status(1).state, reader_state::running);
  const auto found = service->motion_diagnosis();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].level, diagnostic_level::warn);
  EXPECT_THAT(found[0].message, HasSubstr("front"));
  EXPECT_EQ(service->change_now(0, {{"frequency", 8.0}}, patience), "the lidar is not connected");
  service->stop();
  EXPECT_EQ(heard.scans.back().kept_of_each[0], 0U);
  EXPECT_LT(most_of(distances_to_walls(last, {})), 0.05);
  const auto lost = std::ranges::find(heard.events, lidar_event::kind::lost,
                                      &decltype(heard.events)::value_type::first);
  ASSERT_NE(lost, heard.events.end());
  EXPECT_LT(std::abs(lost->second - std::chrono::nanoseconds(wall).count()),
            std::chrono::nanoseconds(patience).count());
  const auto all = service->diagnosis();
  EXPECT_THAT(all.front().name, HasSubstr("g4lidar: front "));
  EXPECT_EQ(all.back().name, "g4lidar: merging");
}

/// Wants points of two of eight scans, from the end of a scan of the first lidar on.
class toggling_sink final : public sink_record {
 public:
  void on_measured(std::size_t lidar, const scan& /*found*/) override {
    if (lidar == 0) want({.for_grid = true, .kept = ++count_ % 8 < 2});
  }

 private:
  unsigned count_ = 0;
};

TEST_F(ServiceMerging, PointsThatWereNotWantedForAWhile_AreNotGivenLater) {
  toggling_sink toggling;
  outputs = {{&toggling, delivery::in_reader}};
  begin_both();
  ASSERT_TRUE(toggling.wait_for_scans(40));
  service->stop();
  std::size_t empty = 0;
  std::size_t old = 0;  // with points older than two revolutions; a busy machine has some
  for (const seen_scan& each : toggling.scans) {
    const auto is_old = [&](const point& p) {
      return each.about.first_ns - p.time_ns > second / 2;
    };
    if (each.kept.empty()) ++empty;
    if (std::ranges::any_of(each.kept, is_old)) ++old;
  }
  EXPECT_GE(empty, 20U);
  EXPECT_LT(empty, toggling.scans.size() - 2);
  EXPECT_LE(old, (toggling.scans.size() - empty) / 4);
}

/// 0.2 m a second ahead.
constexpr const char* ahead =
    "pose 0 -1 0 0\npose 5 0 0 0\npose 10 1 0 0\npose 15 2 0 0\npose 20 3 0 0\n";

TEST_F(ServiceMerging, OnASimulatedRobot_PlacesAreThoseOfItsOdometry) {
  begin_both({.follows_motion = true}, "", ahead);
  EXPECT_TRUE(service->has_odometry());
  std::optional<seen_scan> last;
  ASSERT_TRUE(heard.wait([&] {
    if (heard.scans.size() < 6) return false;
    const seen_scan& now = heard.scans.back();
    const auto is_deskewed = [&](const point& p) { return p.time_ns == now.about.first_ns; };
    if (!now.about.place || now.kept_of_each.size() != 2 ||
        std::ranges::min(now.kept_of_each) <= 800 || !std::ranges::all_of(now.kept, is_deskewed))
      return false;
    last.emplace(now);
    return true;
  })) << "a busy machine reads some odometry too late, but not all";
  service->stop();
  // The odometry begins with 0,0,0 at -1,0,0.
  const auto& [pose, stamp_ns] = heard.poses.back();
  const double seconds = static_cast<double>(last->about.first_ns - pose.time_ns) * 1e-9;
  EXPECT_NEAR(last->about.place->pose.x_m, pose.pose.x_m + 0.2 * seconds, 0.002);
  EXPECT_LT(most_of(distances_to_walls(last->kept, pose_2d{-1, 0, 0} * last->about.place->pose)),
            0.08);
}

TEST_F(ServiceMerging, ByTheScans_TheRobotMovesAhead) {
  begin_both({.deskew = deskewing::by_scans}, "", ahead);
  // Where the scans do not show the motion for a while, another map begins; a busy machine loses scans.
  std::optional<service_scan> first;
  int right = 0;  // more than wrong ones
  ASSERT_TRUE(heard.wait([&] {
    if (heard.scans.empty() || !heard.scans.back().about.place) return false;
    const service_scan& now = heard.scans.back().about;
    if (!first || first->place->map != now.place->map) first = now;
    const double seconds = static_cast<double>(now.first_ns - first->first_ns) * 1e-9;
    if (seconds < 1.5) return false;
    const pose_2d way = inverse(std::exchange(first, now)->place->pose) * now.place->pose;
    right += std::abs(way.x_m - 0.2 * seconds) < 0.1 && std::abs(way.y_m) < 0.1 ? 1 : -1;
    return right >= 2;
  })) << "the robot drives for 20 s";
}

TEST(ServiceLidars, AreOneTo32_OfDifferentNames) {
  const auto problem_of = [](std::vector<service_lidar> lidars) {
    const auto made = lidar_service::make(std::move(lidars), {}, {});
    EXPECT_TRUE(made || made.error() == problem::bad_option);
    return made ? std::string() : std::string(made.error().subject());
  };
  std::vector<service_lidar> lidars;
  EXPECT_NE(problem_of(lidars), "");
  for (int i = 0; i < 33; ++i) {
    service_lidar& made = lidars.emplace_back();
    made.name = std::to_string(i);
    made.options.device = "sim:";
    if (i != 0 && i != 31) continue;
    EXPECT_EQ(problem_of(lidars), "");
  }
  EXPECT_THAT(problem_of(lidars), HasSubstr("32"));
  EXPECT_THAT(problem_of({lidars[0], lidars[1], lidars[0]}), HasSubstr("the same name"));
  service_lidar file = lidars[1];
  file.options.device = "file:/nowhere";
  EXPECT_THAT(problem_of({lidars[0], file}), HasSubstr("a clock of its own"));
  lidars.resize(1);
  EXPECT_FALSE(lidar_service::make(lidars, {}, {{nullptr}}));
  for (const char* const wrong : {"speed", "range_min", "model"}) {
    lidars[0].settings = {{wrong, 1.0}};
    EXPECT_THAT(problem_of(lidars), HasSubstr(wrong));
  }
}

}  // namespace
}  // namespace g4lidar::test
