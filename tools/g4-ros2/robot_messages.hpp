// SPDX-License-Identifier: MIT
// The robot that carries a lidar: its odometry and frames as messages, and the odometry of others.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "dds/bus.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/scan_shaper.hpp"
#include "ros2_options.hpp"

namespace g4_tool {

/// What a source knows of the robot.
struct robot_knowledge {
  bool has_odometry = false;
  bool has_clock = false;
};

/// The topics of the robot as a recording or the simulated G4 knows it: odom, /tf, and /clock of a
/// recording. *Single thread.*
class robot_messages {
 public:
  robot_messages(dds::bus& bus, const ros2_options& options, std::string_view name_space,
                 const robot_knowledge& known);

  /// A pose, at a time since 1970.
  void publish(const stamped_odometry& odometry, std::int64_t stamp_ns);
  /// The time of a recording, since 1970; at most a hundred times a second.
  void publish_clock(std::int64_t now_ns);

 private:
  const ros2_options& options_;
  std::unique_ptr<dds::publisher> odometry_;  // null where it is not known, or off
  std::unique_ptr<dds::publisher> tf_;
  std::unique_ptr<dds::publisher> clock_;
  std::int64_t clock_ns_ = 0;  // as it was published
  std::vector<std::uint8_t> message_;
};

/// Where odometry_subscription looks: "on /odom".
[[nodiscard]] std::string where_odometry_is(const ros2_options& options,
                                            std::string_view name_space);

/// The place of a lidar on the robot, for /tf_static. `options.order` may turn its frame.
[[nodiscard]] std::vector<std::uint8_t> place_message(const ros2_options& options,
                                                      const std::string& frame_id,
                                                      const mounting& place);

/// The odometry that others publish, not this program. *Any thread.*
class odometry_subscription final : public dds::endpoint {
 public:
  odometry_subscription(dds::bus& bus, std::string name);

  void open(dds_entity_t participant, int* handle) override;
  void close() noexcept override;

  /// Adds what has come; `ahead_ns`: the wall clock minus the clock of the path.
  void take(odometry_path& into, std::int64_t ahead_ns);

 private:
  std::string name_;
  std::mutex mutex_;
  dds::entity topic_;
  dds::entity reader_;
};

}  // namespace g4_tool
