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

/// Of a parameter that is set at the start only.
descriptor fixed(const std::string& description, const std::string& constraints = {}) {
  descriptor made;
  made.description = description;
  made.additional_constraints = constraints;
  made.read_only = true;
  return made;
}

/// Of one that can be set while the node runs.
descriptor changeable(const std::string& description, const std::string& constraints = {}) {
  descriptor made = fixed(description, constraints);
  made.read_only = false;
  // Humble converts a value after the types are compared.
  made.dynamic_typing = !RCLCPP_VERSION_GTE(21, 0, 0);
  return made;
}

descriptor limited(descriptor made, double least, double most, double step = 0.0) {
  made.floating_point_range.resize(1);
  made.floating_point_range[0].from_value = least;
  made.floating_point_range[0].to_value = most;
  made.floating_point_range[0].step = step;
  return made;
}

descriptor counted(descriptor made, std::int64_t most) {
  made.integer_range.resize(1);
  made.integer_range[0].to_value = most;
  made.integer_range[0].step = 1;
  return made;
}

/// Declares a parameter with the value that the program was started with, which gets the type of `first`.
void declare(rclcpp_lifecycle::LifecycleNode& node, const std::string& name, const value& first,
             const descriptor& how) {
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

/// The filters that keep everything, and no settings.
value first_value(const g4lidar::parameter& of) {
  if (of.setting != nullptr) return shown(of, {});
  if (of.name == "range_min") return value(0.0);
  if (of.name == "range_max") return value(100.0);
  if (of.name == "no_return") return value("inf");
  if (of.name == "near_as") return value("nan");
  return value(of.name == "fov" || of.name == "ignore" ? "" : "off");
}

/// A filter or a setting.
void declare(rclcpp_lifecycle::LifecycleNode& node, const g4lidar::parameter& of) {
  descriptor made = changeable(of.description, of.constraints);
  if (of.setting != nullptr) made.additional_constraints += "; 0 or empty: as the lidar has it";
  if (of.name == "fov") made.additional_constraints += "; empty: from angle_min to angle_max";
  if (const auto [least, most, step] = of.range; least < most) {
    if (of.setting != nullptr) made.additional_constraints += "; " + sector_text(least, most);
    made = limited(made, of.setting != nullptr ? 0.0 : least, most, step);
  }
  declare(node, std::string(of.name), first_value(of), made);
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

value value_or(const g4lidar::parameter_value& from, const value& otherwise) {
  return std::visit(
      [&]<class Value>(const Value& one) {
        if constexpr (std::is_same_v<Value, std::monostate>)
          return otherwise;
        else
          return value(one);
      },
      from);
}

/// The settings of the lidar, within the limits of its model, and what it has.
void declare_settings(rclcpp_lifecycle::LifecycleNode& node) {
  std::string word = node.get_parameter("model").as_string();
  if (word.ends_with('!')) word.pop_back();
  const g4lidar::model* const model = g4lidar::model_named(word);
  for (const g4lidar::parameter& each : g4lidar::all_parameters()) {
    if (each.kind != g4lidar::parameter_kind::read_only)
      declare(node, model != nullptr ? g4lidar::limited_to(*model, each) : each);
    if (!has_state(each)) continue;
    descriptor made;
    made.description = "As the lidar has it: " + each.description;
    made.additional_constraints = "only the node changes it; 0 or empty: not known";
    node.declare_parameter(std::string(state_prefix).append(each.name), shown(each, {}), made,
                           true);
  }
}

}  // namespace

void declare_parameters(rclcpp_lifecycle::LifecycleNode& node) {
  declare(node, "source", value(""),
          fixed("The lidar or the recording; empty: the only lidar",
                "/dev/ttyUSB0, serial:NUMBER, usb:PATH, tcp:HOST:PORT, a file, or sim:"));
  // As an empty array of a parameter file has no type.
  const value nothing(std::vector<std::string>{""});
  declare(node, "sources", nothing,
          fixed("Two lidars or more whose scans are merged, in base_frame, instead of source",
                "NAME=SOURCE each; no files"));
  declare(
      node, "mounts", nothing,
      fixed("Where those of sources are on the robot", "NAME=X,Y,DEG or NAME=X,Y,DEG,down each"));
  declare(node, "model", value(""),
          fixed("Model; empty: the lidar is searched, or as recorded",
                g4lidar::model_words() + "; x4! as with insist_on_model"));
  declare(node, "insist_on_model", value(false),
          fixed("The model is right, whatever number the lidar reports"));
  declare(node, "listen_only", value(false),
          fixed("Send not a byte: for a data wire alone, or a lidar that another computer drives"));
  declare(node, "leave_dtr", value(false),
          fixed("Do not set the line DTR of the port: a motor that it drives keeps its state"));
  declare(node, "baud", value(0),
          counted(fixed("Bits per second; 0: those of the model"), 10'000'000));
  declare(node, "frame_id", value("laser"), fixed("Frame of the scans"));
  declare(node, "grid", value(0),
          counted(fixed("Ranges of each LaserScan; 0: those of the model"), 65536));
  declare(node, "order", value("angle"),
          fixed("Order of the ranges of a LaserScan", "angle, time"));
  declare(node, "base_frame", value("base_link"), fixed("Frame of the robot"));
  declare(node, "odometry_frame", value("odom"), fixed("Frame of the odometry"));
  declare(node, "mount", value(""),
          fixed("Where the lidar is on the robot, for /tf_static and deskewing",
                "X,Y,DEG or X,Y,DEG,down, in metres and degrees; empty: unknown"));
  declare(node, "deskew", value("none"),
          fixed("By what each revolution is deskewed; tf: from odometry_frame to base_frame",
                "none, scans, odometry, tf"));
  declare(node, "playback_speed", value(1.0),
          limited(fixed("Speed of a recording; 1: as recorded"), 0.01, 100.0));
  declare(node, "loop", value(false), fixed("Start a recording again at its end"));
  declare(
      node, "connect_timeout", value(0.0),
      limited(fixed("How long the lidar may be missing until the node is unconfigured, s; 0: for "
                    "ever"),
              0.0, 3600.0));
  declare(node, "bond_heartbeat_period", value(0.0),
          limited(fixed("Period of a bond with a lifecycle manager, s: 0.1 for Nav2; 0: none"), 0.0,
                  10.0));
  declare(node, "autostart", value(false),
          fixed("Whether the node configures and activates itself at the start"));
  declare(node, "standby", value(false),
          changeable("Whether the motor rests while nobody subscribes to a scan or a cloud"));
  declare(node, "angle_min", value(-180.0),
          limited(changeable("First direction that is kept, degrees counter-clockwise from ahead"),
                  -360.0, 360.0));
  declare(node, "angle_max", value(180.0),
          limited(changeable("Last direction that is kept, counter-clockwise from angle_min"),
                  -360.0, 360.0));
  declare(node, "mask", value(""),
          fixed("File of polygons, parts of the robot: returns inside are left out"));
  declare_settings(node);
}

rclcpp::ParameterValue converted(const value& from, rclcpp::ParameterType to) {
  const std::string sectors = to == rclcpp::PARAMETER_STRING ? sectors_in(from) : "";
  if (!sectors.empty()) return value(sectors);
  return value_or(g4lidar::converted(value_of(from), static_cast<std::uint8_t>(to)), from);
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

rclcpp::ParameterValue shown(const g4lidar::parameter& of, const g4lidar::parameter_value& known) {
  const value nothing = of.type == rclcpp::PARAMETER_INTEGER  ? value(0)
                        : of.type == rclcpp::PARAMETER_DOUBLE ? value(0.0)
                                                              : value("");
  return value_or(g4lidar::converted(known, nothing.get_type()), nothing);
}

}  // namespace g4lidar_ros
