// SPDX-License-Identifier: MIT
#include "scan_sender.hpp"

#include <utility>

#include "g4lidar/grid.hpp"
#include "g4lidar/message/ros_messages.hpp"

namespace g4_tool {

scan_sender::scan_sender(const serve_options& options, client_registry& to)
    : registry_(to),
      frame_id_(frame_id_of(options)),
      bins_(options.bins),
      grid_(options.common.grid) {
  grid_.longest_mm = options.common.filter.greatest_range_mm;
}

void scan_sender::send_page(const page_scan& what) {
  std::vector<std::uint8_t> message;
  message.reserve(128 + 10 * what.revolution.size());
  put_page_scan(what, message);
  registry_.page_scan(std::move(message));
}

void scan_sender::send_ranges(const g4lidar::scan& for_grid, const scan_stamp& when) {
  const g4lidar::model& model = *for_grid.model;
  message_header header{.stamp_ns = when.stamp_ns,
                        .frame_id = frame_id_,
                        .duration_ns = when.duration_ns,
                        .model = &model};
  fill_laser_scan(for_grid, header, bins_.value_or(default_bins(model)), grid_, ranges_m_,
                  intensities_);
  std::vector<std::uint8_t> message;
  put_laser_scan(ranges_m_, header, message);
  registry_.publish(channel::scan, when.stamp_ns, std::move(message));
}

void scan_sender::send_points(const g4lidar::scan& kept, const scan_stamp& when,
                              std::int64_t time_ns) {
  const std::int64_t since_ns = kept.empty() ? 0 : cloud_time_ns(kept.points) - time_ns;
  std::vector<std::uint8_t> message;
  put_point_cloud2(kept.points,
                   {.stamp_ns = when.stamp_ns + since_ns,
                    .frame_id = frame_id_,
                    .duration_ns = when.duration_ns,
                    .model = kept.model},
                   message);
  registry_.publish(channel::points, when.stamp_ns, std::move(message));
}

void scan_sender::send_bytes(std::int64_t stamp_ns, std::vector<std::uint8_t> message) {
  registry_.publish(channel::from_device, stamp_ns, std::move(message));
}

}  // namespace g4_tool
