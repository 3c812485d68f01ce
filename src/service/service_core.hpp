// SPDX-License-Identifier: MIT
// What the lidars of a service have in common: filters, the motion of the robot, merging, and the sinks.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "g4lidar/lidar_service.hpp"
#include "g4lidar/options/lidar_parameters.hpp"
#include "g4lidar/scan_shaper.hpp"
#include "service/motion_watch.hpp"
#include "service/place_tracker.hpp"
#include "service/scan_merger.hpp"
#include "service/sink_group.hpp"

namespace g4lidar {

/// What is known of the motion of a robot when its lidar is opened.
struct known_motion {
  bool has_odometry = false;          ///< The source states it.
  std::optional<mounting> simulated;  ///< Where a simulated robot has the lidar.
};

class service_core {
 public:
  service_core(service_options options, const std::vector<service_lidar>& lidars,
               const std::vector<service_output>& outputs);

  [[nodiscard]] const service_options& options() const noexcept { return options_; }
  [[nodiscard]] sink_group& sinks() noexcept { return sinks_; }
  [[nodiscard]] bool is_merged() const noexcept { return merger_.has_value(); }
  /// Of all lidars.
  [[nodiscard]] const lidar_parameters& filters() const noexcept { return filters_; }

  /// Why these filters cannot be set, or empty. *Any thread.*
  [[nodiscard]] std::string problem_with(std::span<const named_value> wanted) const;
  /// Sets them for the next scan of each lidar: the same. *Any thread.*
  [[nodiscard]] std::string set_filters(std::span<const named_value> wanted);

  /// Before all else. `has_odometry`: whether the source states the motion.
  void begin(bool has_odometry);

  // In the threads of the lidars.
  void opened(std::size_t lidar, const known_motion& motion);
  /// A pose that the source states.
  void add(const stamped_odometry& now, std::int64_t stamp_ns, std::uint64_t begun);
  /// The next scan of a lidar.
  void add(std::size_t lidar, const scan& found, std::optional<std::int64_t> ahead_ns);

  /// Statuses of merging and deskewing. *One thread at a time.*
  [[nodiscard]] std::vector<diagnostic_status> diagnosis();

 private:
  /// The shaping of a lidar, of its thread.
  struct shaping {
    std::optional<mounting> mount;  // as it was given
    mounting place;
    deskewing deskew = deskewing::none;
    bool has_odometry = false;
    unsigned version = 0;  // of the filters
    filter_settings filters;
    scan_shaper shaper;
  };
  void update(shaping& of);
  void add_single(shaping& lidar, const scan& found, std::optional<std::int64_t> ahead_ns);
  void add_merged(std::size_t lidar, const scan& found, std::optional<std::int64_t> ahead_ns);
  void give(service_scan& made, std::size_t points, std::size_t outside);
  void take_other_odometry(const shaping& lidar, const scan& found,
                           std::optional<std::int64_t> ahead_ns);

  const service_options options_;
  sink_group sinks_;
  mutable std::mutex changes_;  // of the next one
  lidar_parameters filters_;
  std::atomic<unsigned> version_ = 1;
  std::deque<shaping> lidars_;
  std::optional<scan_merger> merger_;
  // Of the thread of the only lidar, or under the lock of the sinks:
  odometry_path path_;
  std::uint64_t begun_ = 0;
  place_tracker tracker_;
  std::optional<motion_watch> watch_;
};

}  // namespace g4lidar
