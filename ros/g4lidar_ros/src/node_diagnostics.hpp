// SPDX-License-Identifier: MIT
// The statuses of the node on /diagnostics.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <diagnostic_updater/diagnostic_updater.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>

#include "lidar_session.hpp"

namespace g4lidar_ros {

/// "state" with the model and the settings, stages and "counts" of each lidar, with its name; "merging", "deskewing" and
/// "topics", once a second. *Single thread*: that of the node.
class node_diagnostics {
 public:
  /// After the parameters were declared.
  explicit node_diagnostics(rclcpp_lifecycle::LifecycleNode& node);

  /// The lidars that are reported; null: none is open.
  void follow(std::shared_ptr<lidar_session> session) { session_ = std::move(session); }

 private:
  using wrapper = diagnostic_updater::DiagnosticStatusWrapper;
  void add_lidar(std::size_t index, const std::string& prefix);
  /// A status of the service, which may have none of this name.
  void add(const std::string& name);
  void report(const std::string& name, wrapper& status) const;
  void report_state(std::size_t lidar, const std::string& name, wrapper& status);
  void report_topics(wrapper& status);

  std::shared_ptr<lidar_session> session_;
  std::vector<g4lidar::diagnostic_status> found_;  // by the service, for this report
  std::uint64_t refused_ = 0;                      // at the last report
  diagnostic_updater::Updater updater_;
};

}  // namespace g4lidar_ros
