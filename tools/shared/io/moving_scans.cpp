// SPDX-License-Identifier: MIT
#include "moving_scans.hpp"

#include <numbers>

#include "g4lidar/source.hpp"
#include "shape_files.hpp"

namespace g4_tool {

moving_scans::moving_scans(const common_options& options, bool restamps)
    : options_(options), mask_(mask_in(options.mask)), restamps_(restamps) {
  const bool uses_odometry = options.deskew == deskewing::by_path || options.mount;
  if (uses_odometry && kind_of_source(options.source) == source_kind::recording) {
    feed_.set(odometry_of_recording(path_of_source(options.source)));
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
  if (deskew_ == deskewing::by_path) {
    place_ = tracker_.by_path(path, mount_.pose, source.time_ns(), feed_.begun());
  }
  if (deskew_ == deskewing::by_scans) {
    std::optional<twist_2d> twist = shaper_.twist();
    if (twist) twist = mount_.upright(*twist);
    place_ = tracker_.by_twist(twist, source.time_ns());
  }
}

}  // namespace g4_tool
