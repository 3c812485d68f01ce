// SPDX-License-Identifier: MIT
#include "trails.hpp"

#include <cmath>

#include "g4lidar/cartesian.hpp"
#include "io/far_times.hpp"

namespace g4_tool {
namespace {

using g4lidar::xy_point;

constexpr std::int64_t ns_in_s = 1'000'000'000;
constexpr double way_step_m = 0.05;
constexpr std::size_t most_of_way = 4096;
/// So far from the middle, as a part of the range, the robot is before the picture follows it.
constexpr double free_part = 0.5;

/// Places in the frame of a pose, in the frame around it.
class placing {
 public:
  explicit placing(const pose_2d& by) : by_(by), turned_(g4lidar::rotation_by(by.yaw_rad)) {}
  [[nodiscard]] xy_point operator()(const xy_point& at) const {
    const auto x = static_cast<double>(at.x_m);
    const auto y = static_cast<double>(at.y_m);
    return {static_cast<float>(by_.x_m + turned_.cosine * x - turned_.sine * y),
            static_cast<float>(by_.y_m + turned_.sine * x + turned_.cosine * y), 0};
  }

 private:
  pose_2d by_;
  g4lidar::rotation turned_;
};

}  // namespace

void trails::add(const g4lidar::scan& newest, const std::optional<lidar_place>& place) {
  if (!place || !place_ || place->map != place_->map) {
    kept_.clear();
    way_.clear();
    middle_ = place ? pose_2d{place->pose.x_m, place->pose.y_m, 0} : pose_2d{};
  }
  place_ = place;
  if (!place) return;
  const auto x = static_cast<float>(place->pose.x_m);
  const auto y = static_cast<float>(place->pose.y_m);
  const bool is_far =
      way_.empty() || std::hypot(static_cast<double>(x - way_.back().x_m),
                                 static_cast<double>(y - way_.back().y_m)) > way_step_m;
  if (is_far && way_.size() == most_of_way) way_.erase(way_.begin());
  if (is_far) way_.push_back({x, y, 0});
  const placing in_map(place->pose);
  revolution& now = kept_.emplace_back(revolution{newest.time_ns(), {}});
  if (length_s_ > 0) {
    for (const point& each : newest) {
      if (each.is_no_return()) continue;
      now.returns.push_back(in_map(to_xy(each, g4lidar::frame::robot, newest.model->turn_deg)));
    }
  }
  while (way_ns(kept_.front().time_ns, now.time_ns) > length_s_ * ns_in_s) kept_.pop_front();
}

void trails::change_length() {
  if (length_s_ == 0) {
    length_s_ = 2;
  } else {
    length_s_ = length_s_ == 2 ? 10 : 0;
  }
}

void trails::show(radar_view& view, bool wants_map) {
  shown_.clear();
  view.robot = {};
  view.traces = {};
  view.is_map = false;
  if (!place_ || view.frame != g4lidar::frame::robot) return;
  view.is_map = wants_map;
  const pose_2d& robot = place_->pose;
  if (std::abs(robot.x_m - middle_.x_m) > free_part * view.range_m ||
      std::abs(robot.y_m - middle_.y_m) > free_part * view.range_m) {
    middle_ = {robot.x_m, robot.y_m, 0};
  }
  const pose_2d map = view.is_map ? inverse(middle_) : inverse(robot);
  if (view.is_map) view.robot = map * robot;
  const placing in_picture(map);
  for (const xy_point& each : way_) shown_.push_back(in_picture(each));
  for (const revolution& each : kept_) {
    for (const xy_point& at : each.returns) shown_.push_back(in_picture(at));
  }
  view.traces = shown_;
}

}  // namespace g4_tool
