// SPDX-License-Identifier: MIT
// One lidar, or several merged ones, that are open: their service, and their topics.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <rclcpp_lifecycle/lifecycle_node.hpp>

#include "g4lidar/lidar_service.hpp"
#include "odometry_publisher.hpp"
#include "topics.hpp"

namespace g4lidar_ros {

/// What does not change while lidars are open.
struct session_options {
  std::vector<g4lidar::service_lidar> lidars;  ///< At least one.
  g4lidar::service_options service;
  std::vector<g4lidar::named_value> filters;  ///< At the beginning.
  std::string frame_id;
  std::optional<std::uint32_t> bins;  ///< Nothing: default_bins() of the model.
  g4lidar::scan_order order = g4lidar::scan_order::angle;
  motion_options motion;
};

/// Publishes in the threads of the lidars while the publishers are active. *Any thread* may call its functions.
class lidar_session final : private g4lidar::service_sink {
 public:
  /// Adds the topics of its source. `node` and `topics` outlive it. Throws what rclcpp throws, and std::invalid_argument
  /// for what the service refuses.
  lidar_session(rclcpp_lifecycle::LifecycleNode& node, lidar_topics& topics,
                session_options options);
  /// Stops the motors and closes the lidars.
  ~lidar_session() override;

  /// Opens the lidars in their threads; the motors rest. Does not wait for devices. A file or a simulated lidar is open at
  /// once, or cannot be opened: waits until that is known, at most 1 s. Fails with system.
  [[nodiscard]] g4lidar::result<void> start();
  /// Whether motors may run; if not, waits at most `longest` until they rest.
  void allow(bool runs, std::chrono::nanoseconds longest = {});
  /// Whether motors rest while nobody subscribes.
  void set_standby(bool rests) noexcept { is_standby_ = rests; }
  /// Changes settings of each lidar, and filters, all or none: why not, or empty. Blocks until the lidars have answered;
  /// not while one is searched.
  [[nodiscard]] std::string change(const std::vector<g4lidar::named_value>& wanted);
  /// The value that all lidars have of a parameter.
  [[nodiscard]] g4lidar::parameter_value known(const g4lidar::parameter& row) const;
  /// Whether something became known since the last call.
  [[nodiscard]] bool has_news() noexcept { return is_news_.exchange(false); }
  /// A file that is at its end begins again. Blocks until it does.
  void restart_file();

  /// Whether no scans follow.
  [[nodiscard]] bool has_ended() const { return service_->has_ended(); }
  /// Why all lidars have ended, if that is an error; not at the end of a file.
  [[nodiscard]] std::optional<g4lidar::error> failure() const;
  [[nodiscard]] g4lidar::lidar_service& service() noexcept { return *service_; }
  [[nodiscard]] const lidar_topics& topics() const noexcept { return topics_; }

 private:
  [[nodiscard]] g4lidar::service_demand wanted() const override;
  void on_open(std::size_t lidar, g4lidar::lidar& device) override;
  void on_values(std::size_t lidar, const std::string& refused) override;
  void on_scan(const g4lidar::service_scan& made) override;
  void on_event(std::size_t lidar, const g4lidar::lidar_event& event,
                std::int64_t stamp_ns) override;
  void on_state(std::size_t lidar, g4lidar::reader_state state,
                const std::optional<g4lidar::error>& why) override;
  /// A text about a lidar, with its name if there are several.
  [[nodiscard]] std::string named(std::size_t lidar, const std::string& text) const;
  /// Changes those of one lidar.
  [[nodiscard]] std::string change(std::size_t lidar,
                                   const std::vector<g4lidar::named_value>& wanted);
  /// Waits until that is so, at most as long, and not while the program ends.
  template <class Condition>
  void wait(std::chrono::nanoseconds longest, Condition condition);
  /// Whether `condition(lidar, state)` is true of each lidar.
  template <class Condition>
  [[nodiscard]] bool is_each(Condition condition) const;

  rclcpp_lifecycle::LifecycleNode& node_;
  lidar_topics& topics_;
  session_options options_;
  const bool is_file_;
  odometry_publisher motion_;
  std::atomic<bool> is_standby_ = false;
  std::atomic<bool> is_news_ = false;
  std::mutex mutex_;
  std::condition_variable
      changed_;  // the state of a lidar, a change of its values, or the next one
  std::atomic<bool> is_ending_ = false;
  rclcpp::PreShutdownCallbackHandle before_shutdown_;
  std::unique_ptr<g4lidar::lidar_service> service_;  // its threads end first
};

}  // namespace g4lidar_ros
