// SPDX-License-Identifier: MIT
#include "node_diagnostics.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "g4lidar/diagnostics/diagnostic_message.hpp"
#include "parameter_declarations.hpp"

namespace g4lidar_ros {
namespace {

void fill(diagnostic_updater::DiagnosticStatusWrapper& status,
          const g4lidar::diagnostic_status& from) {
  status.summary(static_cast<unsigned char>(from.level), from.message);
  for (const auto& [name, value] : from.values) status.add(name, value);
}

/// With a namespace, statuses have it in their names, so that those of several lidars differ.
rclcpp_lifecycle::LifecycleNode* with_full_name(rclcpp_lifecycle::LifecycleNode& node) {
  rcl_interfaces::msg::ParameterDescriptor made;
  made.description = "Whether the names of statuses contain the namespace";
  made.read_only = true;
  const bool has_namespace = std::string_view(node.get_namespace()) != "/";
  node.declare_parameter("diagnostic_updater.use_fqn", has_namespace, made);
  return &node;
}

}  // namespace

node_diagnostics::node_diagnostics(rclcpp_lifecycle::LifecycleNode& node)
    : updater_(with_full_name(node)) {
  updater_.setHardwareID("none");
  updater_.add("state", this, &node_diagnostics::report_state);
  for (std::size_t i = 0; i < g4lidar::diagnostic_stage_count; ++i) {
    const auto which = static_cast<g4lidar::diagnostic_stage>(i);
    updater_.add(std::string(name_of(which)),
                 [this, which](wrapper& status) { report_stage(which, status); });
  }
  updater_.add("counts", this, &node_diagnostics::report_counts);
  updater_.add("deskewing", this, &node_diagnostics::report_deskewing);
  updater_.add("topics", this, &node_diagnostics::report_topics);
}

void node_diagnostics::report_state(wrapper& status) {
  if (!session_) return status.summary(wrapper::OK, "unconfigured");
  const g4lidar::reader_status now = session_->status();
  if (now.information && now.information->is_known())
    updater_.setHardwareID(std::string(now.information->serial_number()));
  const bool is_end = now.state == g4lidar::reader_state::ended && !session_->failure();
  fill(status, status_of(now, now.why && !is_end ? now.why->message() : ""));
  for (const g4lidar::parameter& each : g4lidar::all_parameters()) {
    const g4lidar::parameter_value known = session_->known().value(each);
    if (has_state(each) && known.index() != 0)
      status.add(std::string(each.name), rclcpp::to_string(shown(each, known)));
  }
}

void node_diagnostics::report_stage(g4lidar::diagnostic_stage which, wrapper& status) {
  if (!session_) return status.summary(wrapper::OK, "unconfigured");
  const auto stages = session_->stages();
  const auto at = std::ranges::find(stages, which, &g4lidar::stage_report::stage);
  if (at == stages.end()) return status.summary(wrapper::OK, "ok");
  fill(status, g4lidar::status_of(*at, ""));
}

void node_diagnostics::report_counts(wrapper& status) {
  if (!session_) return status.summary(wrapper::OK, "unconfigured");
  fill(status, g4lidar::status_of(session_->counts(), ""));
}

void node_diagnostics::report_topics(wrapper& status) {
  if (!session_) return status.summary(wrapper::OK, "unconfigured");
  std::uint64_t refused = 0;
  const auto add = [&](const auto& topic) {
    const std::string name = topic.name();
    status.add(name + " subscribers", topic.subscribers());
    status.add(name + " sent", topic.counts().sent.load());
    status.add(name + " refused", topic.counts().refused.load());
    refused += topic.counts().refused;
  };
  add(session_->topics().scans);
  add(session_->topics().clouds);
  const bool is_new = refused > std::exchange(refused_, refused);
  if (is_new)
    status.summary(wrapper::WARN, "a subscriber wants a quality of service that is not offered");
  else
    status.summary(wrapper::OK, "ok");
}

void node_diagnostics::report_deskewing(wrapper& status) {
  const std::uint64_t now = session_ ? session_->points_not_deskewed() : 0;
  const bool is_bad = now > std::exchange(not_deskewed_, now);
  if (is_bad)
    status.summary(wrapper::WARN,
                   "points are not deskewed: the motion at their times is not known");
  else
    status.summary(wrapper::OK, "ok");
  status.add("points_not_deskewed", now);
}

}  // namespace g4lidar_ros
