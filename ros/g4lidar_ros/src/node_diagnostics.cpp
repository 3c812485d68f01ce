// SPDX-License-Identifier: MIT
#include "node_diagnostics.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "parameter_declarations.hpp"

namespace g4lidar_ros {
namespace {

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
  std::vector<std::string> sources = node.get_parameter("sources").as_string_array();
  std::erase(sources, "");  // as node_parameters
  sources.resize(std::max<std::size_t>(1, sources.size()));
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const std::string name = sources[i].substr(0, sources[i].find('='));
    add_lidar(i, name.empty() ? "" : name + " ");
  }
  if (sources.size() > 1) add("merging");
  add("deskewing");
  updater_.add("topics", this, &node_diagnostics::report_topics);
}

void node_diagnostics::add_lidar(std::size_t index, const std::string& prefix) {
  const std::string state = prefix + "state";
  updater_.add(state, [=, this](wrapper& status) { report_state(index, state, status); });
  for (std::size_t i = 0; i < g4lidar::diagnostic_stage_count; ++i)
    add(prefix + std::string(name_of(static_cast<g4lidar::diagnostic_stage>(i))));
  add(prefix + "counts");
}

void node_diagnostics::add(const std::string& name) {
  updater_.add(name, [this, name](wrapper& status) { report(name, status); });
}

void node_diagnostics::report(const std::string& name, wrapper& status) const {
  if (!session_) return status.summary(wrapper::OK, "unconfigured");
  const auto from =
      std::ranges::find(found_, "g4lidar: " + name, &g4lidar::diagnostic_status::name);
  if (from == found_.end()) return status.summary(wrapper::OK, "ok");
  status.summary(static_cast<unsigned char>(from->level), from->message);
  if (!from->hardware_id.empty()) status.hardware_id = from->hardware_id;
  for (const auto& [key, value] : from->values) status.add(key, value);
}

void node_diagnostics::report_state(std::size_t lidar, const std::string& name, wrapper& status) {
  if (session_ && lidar == 0) found_ = session_->service().diagnosis();
  report(name, status);
  if (!session_ || lidar >= session_->service().size()) return;
  if (session_->service().size() == 1) updater_.setHardwareID(status.hardware_id);
  for (const g4lidar::parameter& each : g4lidar::all_parameters()) {
    const g4lidar::parameter_value known = session_->service().value(lidar, each);
    if (has_state(each) && known.index() != 0)
      status.add(std::string(each.name), rclcpp::to_string(shown(each, known)));
  }
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

}  // namespace g4lidar_ros
