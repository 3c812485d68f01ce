// SPDX-License-Identifier: MIT
#include "carried_odometry.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "g4lidar/recording/reader.hpp"
#include "g4lidar/sim/setup.hpp"
#include "g4lidar/source.hpp"

namespace g4lidar_ros {
namespace {

/// Times of points that go back by less do so by the error of the clock.
constexpr std::int64_t least_way_back_ns = 100'000'000;
/// Points are a little older than their bytes, and rounds are further apart.
constexpr std::int64_t largest_age_ns = 5'000'000;

std::vector<g4lidar::stamped_odometry> odometry_in(const std::string& source) {
  std::vector<g4lidar::stamped_odometry> all;
  if (g4lidar::kind_of_source(source) != g4lidar::source_kind::recording) return all;
  auto reader = g4lidar::recording_reader::open(g4lidar::path_of_source(source));
  if (!reader) return all;
  const auto read = reader->for_each([&all](const g4lidar::recorded_item& item) {
    if (item.what == g4lidar::recorded_item::kind::odometry) all.push_back(item.odometry);
    return true;
  });
  static_cast<void>(read);  // what is damaged is left out
  std::ranges::sort(all, {}, &g4lidar::stamped_odometry::time_ns);
  const auto same = std::ranges::unique(all, {}, &g4lidar::stamped_odometry::time_ns);
  all.erase(same.begin(), same.end());
  return all;
}

bool has_simulated_path(const std::string& source) {
  if (!g4lidar::sim::is_simulated(source)) return false;
  const auto read = g4lidar::sim::parse_setup(source);
  const auto* const setup = std::get_if<g4lidar::sim::setup>(&read);
  if (setup == nullptr) return false;
  if (!setup->path_file.empty()) return true;
  const auto scene = g4lidar::sim::load_world(setup->world_file);
  const auto* const world = std::get_if<g4lidar::sim::world>(&scene);
  return world != nullptr && !world->path.empty();
}

}  // namespace

carried_odometry::carried_odometry(const std::string& source)
    : has_robot_(has_simulated_path(source)), recorded_(odometry_in(source)) {}

void carried_odometry::follow(g4lidar::lidar& device,
                              const g4lidar::sim::simulated_source* simulation) {
  robot_ = simulation == nullptr ? std::nullopt : simulation->robot;
  player_ = device.player();
  begin_ns_ = player_ != nullptr ? player_->begin_ns() : robot_ ? simulation->begin_ns : 0;
  has_begun_ = false;
}

void carried_odometry::follow(std::span<const g4lidar::point> points, const taker& take) {
  if (points.empty()) return;
  if (robot_) return follow_robot(points, take);
  if (player_ == nullptr || recorded_.empty()) return;
  const std::int64_t begin_ns = player_->begin_ns();
  if (begin_ns != begin_ns_ && points.front().time_ns >= begin_ns - largest_age_ns) {
    const std::int64_t shift_ns = begin_ns - std::exchange(begin_ns_, begin_ns);
    for (g4lidar::stamped_odometry& each : recorded_) each.time_ns += shift_ns;
    has_begun_ = false;
  }
  const std::int64_t before_ns = std::exchange(points_ns_, points.front().time_ns);
  if (points_ns_ < before_ns - least_way_back_ns) has_begun_ = false;  // the file begins again
  follow_recorded(points, take);
}

void carried_odometry::follow_recorded(std::span<const g4lidar::point> points, const taker& take) {
  if (!std::exchange(has_begun_, true)) {  // of what was before, only the last one is of use
    const auto first = std::ranges::upper_bound(recorded_, points.front().time_ns, {},
                                                &g4lidar::stamped_odometry::time_ns);
    next_ =
        static_cast<std::size_t>(first - recorded_.begin()) - (first == recorded_.begin() ? 0 : 1);
  }
  while (next_ < recorded_.size() &&
         (next_ == 0 || recorded_[next_ - 1].time_ns < points.back().time_ns)) {
    take(recorded_[next_++]);
  }
}

void carried_odometry::follow_robot(std::span<const g4lidar::point> points, const taker& take) {
  while (!has_begun_ || last_ns_ < points.back().time_ns) {
    const g4lidar::sim::odometry_sample at = robot_->next();
    last_ns_ = at.time_ns + begin_ns_;
    has_begun_ = has_begun_ || robot_->next_ns() + begin_ns_ > points.front().time_ns;
    if (!has_begun_) continue;  // of what was before, only the last one is of use
    take({last_ns_,
          {at.x_m, at.y_m, at.yaw_rad},
          {at.forward_m_per_s, at.left_m_per_s, at.yaw_rad_per_s}});
  }
}

}  // namespace g4lidar_ros
