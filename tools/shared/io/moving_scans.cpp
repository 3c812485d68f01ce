// SPDX-License-Identifier: MIT
#include "moving_scans.hpp"

#include <numbers>
#include <utility>

#include "g4lidar/source.hpp"
#include "shape_files.hpp"

namespace g4_tool {
namespace {

/// So long the lidar is taken to keep its velocity where the scans do not show it; a longer gap begins another map.
constexpr std::int64_t longest_gap_ns = 1'000'000'000;

double seconds_of(std::int64_t ns) { return static_cast<double>(ns) * 1e-9; }

}  // namespace

moving_scans::moving_scans(const common_options& options, bool restamps)
    : options_(options), mask_(load_mask(options.mask)), restamps_(restamps) {
  const bool uses_odometry = options.deskew == deskewing::by_path || options.mount;
  if (uses_odometry && kind_of_source(options.source) == source_kind::recording) {
    feed_.load_recording(path_of_source(options.source));
  }
  choose({});
}

void moving_scans::choose(const std::optional<mounting>& simulated) {
  const std::optional<mounting> known = options_.mount ? options_.mount : simulated;
  deskew_ = options_.deskew;
  if (deskew_ == deskewing::none && known && feed_.is_known()) deskew_ = deskewing::by_path;
  mount_ = known.value_or(mounting{});
  shaping_options shape = shape_of(options_, mask_);
  shape.deskew = deskew_;
  shape.mount = mount_;
  shape.restamps = restamps_;
  shaper_.set_options(shape);
}

void moving_scans::open(g4lidar::lidar& device, const sim::simulated_source* simulation) {
  if (player* const played = device.player()) {
    feed_.follow(*played);
  } else {
    feed_.follow(simulation);
  }
  if (simulation == nullptr) return choose({});
  const sim::pose& at = simulation->mounted_at;
  choose(mounting{.pose = {at.x_m, at.y_m, at.heading_deg * std::numbers::pi / 180.0}});
}

void moving_scans::add(const scan& source, const odometry_feed::taker& take) {
  feed_.follow(source.points, [&](const stamped_odometry& at) {
    path_.add(at);
    if (take) take(at);
  });
  const auto path = path_.until(source.end_ns());
  shaper_.shape(source, path);
  place_.reset();
  if (source.empty() || source.time_ns() == 0) return;
  if (deskew_ == deskewing::by_path) place_ = place_on(path, source.time_ns());
  if (deskew_ == deskewing::by_scans) place_ = place_by_scans(source.time_ns());
}

std::optional<lidar_place> moving_scans::place_on(std::span<const stamped_pose> path,
                                                  std::int64_t time_ns) {
  const auto robot = pose_at(path, time_ns);
  if (!robot) return std::nullopt;
  const pose_2d pose = *robot * mount_.pose;
  // The frame of the odometry is the same one, but the way is another one.
  if (std::exchange(begun_, feed_.begun()) != feed_.begun()) ++map_;
  last_ = {time_ns, pose};
  return lidar_place{pose, map_};
}

std::optional<lidar_place> moving_scans::place_by_scans(std::int64_t time_ns) {
  const bool continues =
      last_ && time_ns > last_->time_ns && time_ns - last_->time_ns <= longest_gap_ns;
  if (!continues) last_.reset();
  const twist_2d before = velocity_;
  if (const auto& twist = shaper_.twist()) {
    velocity_ = *twist;
    if (mount_.upside_down) {
      velocity_.y_m_per_s = -velocity_.y_m_per_s;
      velocity_.yaw_rad_per_s = -velocity_.yaw_rad_per_s;
    }
    known_ns_ = time_ns;
  } else if (!last_ || time_ns - known_ns_ > longest_gap_ns) {
    last_.reset();
    return std::nullopt;
  }
  if (last_) {
    // Each velocity is the mean of two revolutions, at the time between them.
    const twist_2d mean{(before.x_m_per_s + velocity_.x_m_per_s) / 2,
                        (before.y_m_per_s + velocity_.y_m_per_s) / 2,
                        (before.yaw_rad_per_s + velocity_.yaw_rad_per_s) / 2};
    last_->pose = last_->pose * moved_by(mean, seconds_of(time_ns - last_->time_ns));
  } else {
    last_.emplace();
    ++map_;
  }
  last_->time_ns = time_ns;
  return lidar_place{last_->pose, map_};
}

}  // namespace g4_tool
