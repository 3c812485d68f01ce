// SPDX-License-Identifier: MIT
// Revolutions as messages on /scan and /points.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "dds/bus.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/lidar_service.hpp"
#include "g4lidar/message/ros_messages.hpp"
#include "g4lidar/scan.hpp"
#include "ros2_options.hpp"

namespace g4_tool {

/// The counts of topics by their names.
using named_counts = std::vector<std::pair<std::string, dds::publisher_counts>>;

/// The topics of one lidar, or of all that are merged. *Single thread* but for what is marked.
class scan_messages {
 public:
  scan_messages(dds::bus& bus, const ros2_options& options, std::string_view name_space,
                std::string frame_id);

  /// On /scan: service_scan::for_grid.
  void publish_scan(const service_scan& made);
  /// On /points: service_scan::kept.
  void publish_points(const service_scan& made);
  /// Whether somebody reads them. *Any thread.*
  [[nodiscard]] bool wants_scan() const { return scan_ && scan_->is_wanted(); }
  /// The same.
  [[nodiscard]] bool wants_points() const { return points_ && points_->is_wanted(); }
  /// Of those that are published. *Any thread.*
  [[nodiscard]] named_counts counts() const;

 private:
  [[nodiscard]] message_header header_of(const service_scan& made) const;

  const ros2_options& options_;
  std::string frame_id_;
  std::unique_ptr<dds::publisher> scan_;  // null: off
  std::unique_ptr<dds::publisher> points_;
  std::vector<float> ranges_;
  std::vector<float> intensities_;  // empty: the points have none
  std::vector<std::uint8_t> message_;
};

/// The publisher of a topic that the options name; null if it is off.
[[nodiscard]] std::unique_ptr<dds::publisher> publisher_of(dds::bus& bus,
                                                           std::string_view name_space,
                                                           std::string_view name,
                                                           const dds::topic& what);

}  // namespace g4_tool
