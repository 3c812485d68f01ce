// SPDX-License-Identifier: MIT
#include "topics.hpp"

#include <algorithm>

#include <rclcpp/time.hpp>

namespace g4lidar_ros {
namespace {

/// A reliable publisher serves reliable and best-effort subscribers.
rclcpp::QoS scan_quality() { return rclcpp::QoS(5).reliable().durability_volatile(); }

std_msgs::msg::Header header_of(const g4lidar::message_header& from) {
  std_msgs::msg::Header made;
  made.stamp = rclcpp::Time(from.stamp_ns);
  made.frame_id = from.frame_id;
  return made;
}

}  // namespace

lidar_topics::lidar_topics(rclcpp_lifecycle::LifecycleNode& node)
    : scans(node, "scan", scan_quality()), clouds(node, "points", scan_quality()) {}

std::unique_ptr<sensor_msgs::msg::LaserScan> laser_scan_of(const g4lidar::scan& for_grid,
                                                           g4lidar::message_header header,
                                                           const g4lidar::grid_options& grid,
                                                           std::size_t bins) {
  auto made = std::make_unique<sensor_msgs::msg::LaserScan>();
  g4lidar::fill_laser_scan(for_grid, header, bins, grid, made->ranges, made->intensities);
  const g4lidar::laser_scan_numbers numbers = g4lidar::numbers_of(header, bins);
  for (auto* values : {&made->ranges, &made->intensities}) {
    const auto first = std::min(numbers.first, values->size());
    std::rotate(values->begin(), values->begin() + static_cast<std::ptrdiff_t>(first),
                values->end());
  }
  made->header = header_of(header);
  made->angle_min = numbers.angle_min_rad;
  made->angle_max = numbers.angle_max_rad;
  made->angle_increment = numbers.angle_increment_rad;
  made->time_increment = numbers.time_increment_s;
  made->scan_time = numbers.scan_time_s;
  made->range_min = numbers.range_min_m;
  made->range_max = numbers.range_max_m;
  return made;
}

std::unique_ptr<sensor_msgs::msg::PointCloud2> cloud_of(const g4lidar::scan& kept,
                                                        const g4lidar::message_header& header) {
  auto made = std::make_unique<sensor_msgs::msg::PointCloud2>();
  made->header = header_of(header);
  for (const g4lidar::cloud_field& each : g4lidar::cloud_fields(*header.model)) {
    auto& field = made->fields.emplace_back();
    field.name = each.name;
    field.offset = each.offset;
    field.datatype = each.datatype;
    field.count = 1;
  }
  made->point_step = g4lidar::cloud_point_size(*header.model);
  made->data.reserve(kept.size() * made->point_step);
  g4lidar::put_cloud_points(kept.points, header, made->data);
  made->height = 1;
  made->row_step = static_cast<std::uint32_t>(made->data.size());
  made->width = made->row_step / made->point_step;
  made->is_bigendian = false;
  made->is_dense = true;
  return made;
}

}  // namespace g4lidar_ros
