// SPDX-License-Identifier: MIT
#include "parameter_declarations.hpp"

#include <cstdint>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include <rclcpp/version.h>

#include "g4lidar/core/model.hpp"

namespace g4lidar_ros {
namespace {

using descriptor = rcl_interfaces::msg::ParameterDescriptor;
using value = rclcpp::ParameterValue;

/// As ROS describes a row. `of_model`: the limits of a lidar's model.
descriptor described(const g4lidar::parameter& parameter, const g4lidar::parameter_limits& limits) {
  const bool is_setting = parameter.setting != nullptr;
  descriptor made;
  made.name = node_name(parameter);
  made.description = g4lidar::description_of(parameter);
  made.additional_constraints = limits.constraints;
  made.read_only = parameter.kind == g4lidar::parameter_kind::read_only;
  // Humble converts a value after the types are compared.
  made.dynamic_typing = !made.read_only && !RCLCPP_VERSION_GTE(21, 0, 0);
  if (is_setting) made.additional_constraints += "; 0 or empty: as the lidar has it";
  const auto [least, most, step] = limits.range;
  if (!(least < most)) return made;
  const bool has_none = is_setting || !parameter.unset.empty();  // which is 0
  if (is_setting) made.additional_constraints += "; " + sector_text(least, most);
  if (parameter.type == rclcpp::PARAMETER_INTEGER) {
    made.integer_range.resize(1);
    made.integer_range[0].from_value = has_none ? 0 : static_cast<std::int64_t>(least);
    made.integer_range[0].to_value = static_cast<std::int64_t>(most);
    made.integer_range[0].step = 1;
  } else {
    made.floating_point_range.resize(1);
    made.floating_point_range[0].from_value = has_none ? 0.0 : least;
    made.floating_point_range[0].to_value = most;
    made.floating_point_range[0].step = step;
  }
  return made;
}

/// Declares a parameter with the value that the program was started with, which gets the type of `first`.
void declare(rclcpp_lifecycle::LifecycleNode& node, const value& first, const descriptor& how) {
  const std::string& name = how.name;
  const auto& given = node.get_node_parameters_interface()->get_parameter_overrides();
  const auto at = given.find(name);
  const bool is_name = how.read_only && first.get_type() == rclcpp::PARAMETER_STRING;
  const value used = at == given.end() ? first
                     : is_name         ? at->second
                                       : converted(at->second, first.get_type());
  if (used.get_type() != first.get_type())
    throw rclcpp::exceptions::InvalidParameterTypeException(
        name, "it is a " + rclcpp::to_string(first.get_type()) + ", and not a " +
                  rclcpp::to_string(used.get_type()));
  node.declare_parameter(name, used, how, true);
}

/// "30:40 90:100"; nothing if they are not pairs of numbers.
std::string sectors_in(const value& from) {
  std::vector<double> bounds;
  if (from.get_type() == rclcpp::PARAMETER_DOUBLE_ARRAY) bounds = from.get<std::vector<double>>();
  if (from.get_type() == rclcpp::PARAMETER_INTEGER_ARRAY) {
    const auto& whole = from.get<std::vector<std::int64_t>>();
    bounds.assign(whole.begin(), whole.end());
  }
  std::string made;
  for (std::size_t i = 0; i < bounds.size() && bounds.size() % 2 == 0; i += 2)
    made += (i > 0 ? " " : "") + sector_text(bounds[i], bounds[i + 1]);
  return made;
}

value value_or(const g4lidar::parameter_value& given, const value& otherwise) {
  return std::visit(
      [&]<class Value>(const Value& one) {
        if constexpr (std::is_same_v<Value, std::monostate>)
          return otherwise;
        else
          return value(one);
      },
      given);
}

}  // namespace

void declare_parameters(rclcpp_lifecycle::LifecycleNode& node) {
  const g4lidar::model* model = nullptr;
  for (const g4lidar::parameter& each : g4lidar::all_parameters()) {
    if (each.is_of(g4lidar::option_door::node))
      declare(node, first_value(each), described(each, g4lidar::limits_of(each, model)));
    if (each.name == "model") {  // its limits are those of the settings, which follow
      std::string word = node.get_parameter("model").as_string();
      if (word.ends_with('!')) word.pop_back();
      model = g4lidar::model_named(word);
    }
    if (!has_state(each)) continue;
    descriptor made;
    made.description = "As the lidar has it: " + g4lidar::description_of(each);
    made.additional_constraints = "only the node changes it; 0 or empty: not known";
    node.declare_parameter(std::string(state_prefix).append(each.name), shown(each, {}), made,
                           true);
  }
  descriptor merged;
  merged.read_only = true;
  const value nothing(std::vector<std::string>{""});  // an empty array in a file has no type
  merged.name = "sources";
  merged.description = "Lidars whose scans are merged, in base_frame, instead of source";
  merged.additional_constraints = "NAME=SOURCE each, two or more; no files";
  declare(node, nothing, merged);
  merged.name = "mounts";
  merged.description = "Where those of sources are on the robot";
  merged.additional_constraints = "NAME=X,Y,DEG or NAME=X,Y,DEG,down each";
  declare(node, nothing, merged);
}

rclcpp::ParameterValue first_value(const g4lidar::parameter& of) {
  if (of.setting != nullptr) return shown(of, {});
  if (of.type == rclcpp::PARAMETER_BOOL) return value(false);
  return shown(of, std::string(of.usual));
}

std::string node_name(const g4lidar::parameter& of) {
  return std::string(of.node_name.empty() ? of.name : of.node_name);
}

rclcpp::ParameterValue converted(const value& given, rclcpp::ParameterType to) {
  const std::string sectors = to == rclcpp::PARAMETER_STRING ? sectors_in(given) : "";
  if (!sectors.empty()) return value(sectors);
  return value_or(g4lidar::converted(value_of(given), static_cast<std::uint8_t>(to)), given);
}

g4lidar::parameter_value value_of(const value& from) {
  switch (from.get_type()) {
    case rclcpp::PARAMETER_BOOL:
      return from.get<bool>();
    case rclcpp::PARAMETER_INTEGER:
      return from.get<std::int64_t>();
    case rclcpp::PARAMETER_DOUBLE:
      return from.get<double>();
    case rclcpp::PARAMETER_STRING:
      return from.get<std::string>();
    default:
      return {};
  }
}

std::string sector_text(double from, double to) {
  std::ostringstream made;
  made << from << ':' << to;
  return made.str();
}

bool has_state(const g4lidar::parameter& of) {
  return of.setting != nullptr || of.name == "serial_number";
}

rclcpp::ParameterValue shown(const g4lidar::parameter& parameter,
                             const g4lidar::parameter_value& known) {
  const value nothing = parameter.type == rclcpp::PARAMETER_INTEGER  ? value(0)
                        : parameter.type == rclcpp::PARAMETER_DOUBLE ? value(0.0)
                                                                     : value("");
  return value_or(g4lidar::converted(known, nothing.get_type()), nothing);
}

}  // namespace g4lidar_ros
