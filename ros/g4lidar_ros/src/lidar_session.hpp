// SPDX-License-Identifier: MIT
// A lidar that is open: its thread, and its topics.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <rclcpp_lifecycle/lifecycle_node.hpp>

#include "g4lidar/background_reader.hpp"
#include "g4lidar/diagnostics/running_diagnosis.hpp"
#include "g4lidar/lidar_parameters.hpp"
#include "g4lidar/scan_shaper.hpp"
#include "robot_motion.hpp"
#include "topics.hpp"

namespace g4lidar_ros {

/// What does not change while a lidar is open.
struct session_options {
  g4lidar::lidar_options lidar;
  std::string frame_id;
  std::optional<std::uint32_t> bins;  ///< Nothing: default_bins() of the model.
  g4lidar::scan_order order = g4lidar::scan_order::angle;
  g4lidar::shaping_options shaping;
  motion_options motion;
  std::string mask;                           ///< The file of the mask; empty: none.
  std::vector<g4lidar::named_value> filters;  ///< The parameters that are filters.
  /// Those that are settings, which the lidar also has in its options.
  std::vector<g4lidar::named_value> settings;
};

/// Publishes in the thread of the reader while the publishers are active. *Any thread* may call its functions.
class lidar_session final : private g4lidar::reader_listener {
 public:
  /// Adds the topics of its source. `node` and `topics` outlive it. Throws what rclcpp throws, and std::invalid_argument
  /// for a filter or a mask.
  lidar_session(rclcpp_lifecycle::LifecycleNode& node, lidar_topics& topics,
                const session_options& options);
  /// Stops the motor and closes the lidar.
  ~lidar_session() override;

  /// Opens the lidar in the thread; its motor rests. Does not wait for a device. A file or a simulated lidar is open at
  /// once, or cannot be opened: waits until that is known, at most 1 s. Fails with system.
  [[nodiscard]] g4lidar::result<void> start();
  /// Whether the motor is to stand; waits at most `longest` until it does.
  void rest(bool rests, std::chrono::nanoseconds longest = {});
  /// Makes settings, all or none: why not, or empty. Blocks until the lidar has answered; not while it is searched.
  [[nodiscard]] std::string change(const std::vector<g4lidar::named_value>& settings);
  /// Sets filters, which are right, soon: while the lidar is searched, when that is over.
  void filter(std::vector<g4lidar::named_value> filters);
  /// What is known of the lidar: lidar_parameters::value().
  [[nodiscard]] const g4lidar::lidar_parameters& known() const noexcept { return parameters_; }
  /// Whether something became known since the last call.
  [[nodiscard]] bool has_news() noexcept { return is_news_.exchange(false); }
  /// A file that is at its end begins again. Blocks until it does.
  void restart_file();

  [[nodiscard]] g4lidar::reader_status status() const { return reader_.status(); }
  /// Why it has ended, if that is an error; not at the end of a file.
  [[nodiscard]] std::optional<g4lidar::error> failure() const;
  /// Whether somebody subscribes to scans or clouds.
  [[nodiscard]] bool is_wanted() const {
    return topics_.scans.is_wanted() || topics_.clouds.is_wanted();
  }
  /// The judgement of the lidar; of the directions that fov and ignore leave out nothing is expected.
  [[nodiscard]] std::vector<g4lidar::stage_report> stages() const {
    return diagnosis_.stages(parameters_.current_filters());
  }
  [[nodiscard]] g4lidar::lidar_counts counts() const { return reader_.counts(); }
  /// How many points were not deskewed, because their motion is not known.
  [[nodiscard]] std::uint64_t points_not_deskewed() const noexcept { return not_deskewed_; }
  [[nodiscard]] const lidar_topics& topics() const noexcept { return topics_; }

 private:
  void on_open(g4lidar::lidar& device) override;
  void on_scan(const g4lidar::scan& whole) override;
  void on_points(std::span<const g4lidar::point> points) override;
  void on_event(const g4lidar::lidar_event& what) override;
  void on_state(g4lidar::reader_state state, const std::optional<g4lidar::error>& why) override;
  template <class Call>
  void guard(Call call) noexcept;
  /// Makes settings in the thread of the reader: why not, or empty.
  [[nodiscard]] std::string set(g4lidar::lidar* device,
                                const std::vector<g4lidar::named_value>& settings);
  void publish(const g4lidar::scan& whole);
  void publish_clock(std::int64_t now_ns);
  /// The time of stamps minus point::time_ns, which is negative where the time of /clock is less than that since the
  /// machine was started. Nothing before the first /clock, if it is used. Only in the thread of the reader.
  [[nodiscard]] std::optional<std::int64_t> ahead_ns() const;
  /// The stamp of a point::time_ns; 0 before the first /clock. Only in the thread of the reader.
  [[nodiscard]] std::int64_t stamp_ns(std::int64_t time_ns) const;

  rclcpp_lifecycle::LifecycleNode& node_;
  lidar_topics& topics_;
  session_options options_;
  bool is_file_;
  std::int64_t clock_ns_ = 0;  // as published
  robot_motion motion_;
  g4lidar::scan_shaper shaper_;
  std::atomic<std::uint64_t> not_deskewed_ = 0;
  g4lidar::lidar_parameters parameters_;
  std::map<std::string, g4lidar::parameter_value> wanted_;  // the settings, in the thread
  std::atomic<bool> is_news_ = false;
  g4lidar::running_diagnosis diagnosis_;
  const g4lidar::sim::simulated_source* simulation_ = nullptr;  // the lidar's
  std::mutex mutex_;
  std::condition_variable changed_;  // the state of the reader, or the next one
  std::atomic<bool> is_ending_ = false;
  rclcpp::PreShutdownCallbackHandle before_shutdown_;
  g4lidar::background_reader reader_;  // its thread ends first
};

}  // namespace g4lidar_ros
