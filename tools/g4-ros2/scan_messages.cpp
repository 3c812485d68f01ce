// SPDX-License-Identifier: MIT
#include "scan_messages.hpp"

#include <utility>

namespace g4_tool {

std::unique_ptr<dds::publisher> publisher_of(dds::bus& bus, std::string_view name_space,
                                             std::string_view name, const dds::topic& what) {
  if (name == "off") return nullptr;
  dds::topic named = what;
  named.name = full_name(name_space, name);
  return std::make_unique<dds::publisher>(bus, std::move(named));
}

scan_messages::scan_messages(dds::bus& bus, const ros2_options& options,
                             std::string_view name_space, std::string frame_id)
    : options_(options), frame_id_(std::move(frame_id)) {
  const auto topic_of = [&options](const dds::message_type& type) {
    return dds::topic{.type = &type,
                      .is_reliable = options.transport.is_reliable,
                      .depth = options.transport.depth};
  };
  scan_ = publisher_of(bus, name_space, options.topics.scan, topic_of(dds::laser_scan));
  points_ = publisher_of(bus, name_space, options.topics.points, topic_of(dds::point_cloud2));
}

message_header scan_messages::header_of(const service_scan& made) const {
  return {.stamp_ns = made.stamp_ns(made.first_ns),
          .frame_id = frame_id_,
          .duration_ns = made.duration_ns,
          .order = options_.order,
          .model = made.kept.model};
}

void scan_messages::publish_scan(const service_scan& made) {
  message_header header = header_of(made);
  fill_laser_scan(made.for_grid, header, options_.bins.value_or(default_bins(*header.model)),
                  made.grid, ranges_, intensities_);
  message_.clear();
  put_laser_scan(ranges_, header, message_);
  scan_->publish(message_);
}

void scan_messages::publish_points(const service_scan& made) {
  message_header header = header_of(made);
  if (!made.kept.empty()) header.stamp_ns = made.stamp_ns(cloud_time_ns(made.kept.points));
  message_.clear();
  put_point_cloud2(made.kept.points, header, message_);
  points_->publish(message_);
}

named_counts scan_messages::counts() const {
  named_counts all;
  for (const auto* each : {&scan_, &points_}) {
    if (*each) all.emplace_back((*each)->published(), (*each)->counts());
  }
  return all;
}

}  // namespace g4_tool
