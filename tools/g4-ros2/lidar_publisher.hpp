// SPDX-License-Identifier: MIT
// One lidar, or several merged ones, and its topics.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dds/bus.hpp"
#include "g4lidar/lidar_service.hpp"
#include "lidar_diagnostics.hpp"
#include "robot_messages.hpp"
#include "ros2_options.hpp"
#include "scan_messages.hpp"

namespace g4_tool {

class lidar_publisher final : private service_sink {
 public:
  /// `lidars`: one, or those that are merged. `is_first`: of several nodes, the one that publishes /clock. `bus` and
  /// `options` outlive it. Throws a failure, and bad_value.
  lidar_publisher(dds::bus& bus, const ros2_options& options,
                  const std::vector<named_source>& lidars, bool is_first);

  /// Opens the lidars, once. Throws a failure.
  void start();
  /// Publishes due diagnostics. Call it several times a second.
  void update();
  /// Allows or forbids the motors to run, by a command of a user.
  void allow(bool runs) noexcept { service_->allow(runs); }

  [[nodiscard]] bool has_ended() const { return service_->has_ended(); }
  [[nodiscard]] std::size_t size() const noexcept { return lidars_.size(); }
  /// The namespace of the topics of a lidar.
  [[nodiscard]] std::string name_space(std::size_t lidar) const;
  [[nodiscard]] reader_state state(std::size_t lidar) const {
    return service_->status(lidar).state;
  }
  /// Of the first one that has failed.
  [[nodiscard]] std::optional<failure> failure_of_any() const;

 private:
  [[nodiscard]] service_demand wanted() const override;
  void on_open(std::size_t lidar, g4lidar::lidar& device) override;
  void on_scan(const service_scan& made) override;
  void on_odometry(const stamped_odometry& now, std::int64_t stamp_ns) override;
  void on_time(std::size_t lidar, std::int64_t stamp_ns) override;
  void on_motion(bool is_known, const std::string& why) override;
  void on_event(std::size_t lidar, const lidar_event& what, std::int64_t stamp_ns) override;
  void on_state(std::size_t lidar, reader_state state, const std::optional<error>& why) override;
  void on_values(std::size_t lidar, const std::string& refused) override;

  [[nodiscard]] common_options options_of(std::size_t lidar) const;
  [[nodiscard]] std::string why_of(std::size_t lidar, const std::optional<error>& why) const;

  const ros2_options& options_;
  const std::vector<named_source> lidars_;
  const std::string name_space_;
  const bool is_played_;  // a recording
  lidar_diagnostics diagnostics_;
  scan_messages messages_;
  std::unique_ptr<dds::publisher> place_;
  std::unique_ptr<odometry_subscription> driven_;
  std::unique_ptr<robot_messages> robot_;
  std::atomic<std::int64_t> now_ns_ = 0;    // the newest stamp of a recording
  std::unique_ptr<lidar_service> service_;  // its threads end first
};

}  // namespace g4_tool
