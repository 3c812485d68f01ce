// SPDX-License-Identifier: MIT
#include "merger.hpp"

#include <cstdint>

namespace g4_tool {

merger::merger(dds::bus& on, const ros2_options& options, const std::vector<named_source>& lidars)
    : messages_(on, options, options.name_space, options.frames.robot),
      scans_(options.common.deskew, lidars, where_odometry_is(options, options.name_space),
             [this](odometry_path& into, std::int64_t ahead_ns) {
               if (driven_) driven_->take(into, ahead_ns);
             }) {
  if (options.order == scan_order::time) {
    throw bad_value("--merge cannot be used with --order time: a merged scan has no order of time");
  }
  if (options.common.deskew == deskewing::by_path && options.topics.odometry != "off") {
    driven_ = std::make_unique<odometry_subscription>(
        on, full_name(options.name_space, options.topics.odometry));
  }
}

void merger::add(std::size_t index, scan_shaper& scan, const grid_options& grid,
                 const scan_times& when) {
  const bool wants_points = messages_.wants_points();
  scans_.add(index, scan, when, wants_points, [&](const merged_scan& all) {
    if (messages_.wants_scan()) messages_.publish_scan(all.for_grid, grid, all.when);
    if (wants_points) messages_.publish_points(all.kept, all.when);
  });
}

}  // namespace g4_tool
