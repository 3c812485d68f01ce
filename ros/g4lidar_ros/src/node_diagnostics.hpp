// SPDX-License-Identifier: MIT
// The statuses of the node on /diagnostics.
#pragma once

#include <cstdint>
#include <memory>

#include <diagnostic_updater/diagnostic_updater.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>

#include "lidar_session.hpp"

namespace g4lidar_ros {

/// "state" with the model and the settings, the stages of a running_diagnosis, "counts" and "topics", once a second. *Single thread*: that of the node.
class node_diagnostics {
 public:
  explicit node_diagnostics(rclcpp_lifecycle::LifecycleNode& node);

  /// The lidar that is reported; null: none is open.
  void follow(std::shared_ptr<const lidar_session> session) { session_ = std::move(session); }

 private:
  using wrapper = diagnostic_updater::DiagnosticStatusWrapper;
  void report_state(wrapper& status);
  void report_stage(g4lidar::diagnostic_stage which, wrapper& status);
  void report_counts(wrapper& status);
  void report_topics(wrapper& status);
  void report_deskewing(wrapper& status);

  std::shared_ptr<const lidar_session> session_;
  std::uint64_t refused_ = 0;       // at the last report
  std::uint64_t not_deskewed_ = 0;  // the same
  diagnostic_updater::Updater updater_;
};

}  // namespace g4lidar_ros
