// SPDX-License-Identifier: MIT
// One lidar, its thread and its topics.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dds/bus.hpp"
#include "g4lidar/diagnostics/diagnostic_message.hpp"
#include "g4lidar/export/mask.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/odometry_feed.hpp"
#include "g4lidar/odometry_path.hpp"
#include "g4lidar/scan_shaper.hpp"
#include "g4lidar/standby.hpp"
#include "io/deskew_report.hpp"
#include "io/source_reader.hpp"
#include "lidar_diagnostics.hpp"
#include "options.hpp"
#include "robot_messages.hpp"
#include "scan_messages.hpp"

namespace g4_tool {

class merger;

class lidar_node final : public reader_listener {
 public:
  /// `into`: merges its scans, as number `index`; null: it has its own topics. `on`, `options` and `into`
  /// outlive it.
  lidar_node(dds::bus& on, const ros2_options& options, const named_source& which, merger* into,
             std::size_t index);
  ~lidar_node() override;

  /// Starts or stops the motor by subscribers and commands, and publishes due diagnostics. Call it several
  /// times a second.
  void update();
  /// Allows or forbids the motor to run, by a command of a user.
  void allow(bool runs) noexcept { is_allowed_ = runs; }

  /// Adds a status to its diagnostics: see lidar_diagnostics.
  void also_report(std::function<diagnostic_status()> what) {
    diagnostics_.also_report(std::move(what));
  }

  [[nodiscard]] source_reader& device() noexcept { return *device_; }
  [[nodiscard]] const std::string& name_space() const noexcept { return name_space_; }

  void on_open(g4lidar::lidar& device) override;
  void on_scan(const scan& whole) override;
  void on_points(std::span<const point> points) override;
  void on_event(const lidar_event& event) override;
  void on_state(reader_state state, const std::optional<error>& why) override;

 private:
  using clock = std::chrono::steady_clock;

  [[nodiscard]] bool is_wanted() const;
  /// The stamp of a point::time_ns. Only in the thread of the reader.
  [[nodiscard]] std::int64_t stamp_ns(std::int64_t time_ns) const {
    return device_->reader().wall_ns(time_ns);
  }

  const ros2_options& options_;
  named_source which_;
  std::string name_space_;
  merger* merger_;
  std::size_t index_;
  std::unique_ptr<scan_messages> messages_;  // null if its scans are merged
  lidar_diagnostics diagnostics_;
  odometry_feed feed_;  // of the thread of the reader, as robot_, path_ and shaper_
  std::optional<robot_messages> robot_;
  std::atomic<std::int64_t> now_ns_ = 0;  // the newest stamp of a recording
  bool is_played_ = false;                // a recording
  std::unique_ptr<dds::publisher> place_;
  std::unique_ptr<odometry_subscription> driven_;
  odometry_path path_;
  mask mask_;
  scan_shaper shaper_;
  std::unique_ptr<deskew_report> report_;  // null if it does not deskew
  std::atomic<bool> is_allowed_ = true;
  standby standby_;
  std::unique_ptr<source_reader> device_;  // destroyed first
};

}  // namespace g4_tool
