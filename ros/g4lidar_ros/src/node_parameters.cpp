// SPDX-License-Identifier: MIT
#include "node_parameters.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

#include "g4lidar/core/model.hpp"
#include "g4lidar/core/session/model_requests.hpp"
#include "g4lidar/filter_text.hpp"
#include "g4lidar/lidar_parameters.hpp"
#include "g4lidar/setting_table.hpp"

namespace g4lidar_ros {
namespace {

using descriptor = rcl_interfaces::msg::ParameterDescriptor;

/// Of a parameter that is set at the start only.
descriptor fixed(const std::string& description, const std::string& constraints = {}) {
  descriptor made;
  made.description = description;
  made.additional_constraints = constraints;
  made.read_only = true;
  return made;
}

descriptor fixed_number(const std::string& description, double least, double most) {
  descriptor made = fixed(description);
  made.floating_point_range.resize(1);
  made.floating_point_range[0].from_value = least;
  made.floating_point_range[0].to_value = most;
  return made;
}

descriptor fixed_count(const std::string& description, std::int64_t least, std::int64_t most) {
  descriptor made = fixed(description);
  made.integer_range.resize(1);
  made.integer_range[0].from_value = least;
  made.integer_range[0].to_value = most;
  made.integer_range[0].step = 1;
  return made;
}

/// The filters that keep everything.
rclcpp::ParameterValue first_value(const g4lidar::parameter& of) {
  if (of.kind == g4lidar::parameter_kind::device) return {};
  if (of.name == "range_min") return rclcpp::ParameterValue(0.0);
  if (of.name == "range_max") return rclcpp::ParameterValue(100.0);
  if (of.name == "fov") return rclcpp::ParameterValue("-180:180");
  if (of.name == "no_return") return rclcpp::ParameterValue("inf");
  if (of.name == "near_as") return rclcpp::ParameterValue("nan");
  return rclcpp::ParameterValue(
      of.kind == g4lidar::parameter_kind::filter && of.name != "ignore" ? "off" : "");
}

/// What a setting of the device can be. `model`: null if none is named, so that any may be found.
void limit(descriptor& made, const g4lidar::parameter& of, const g4lidar::model* model) {
  if (model != nullptr && !g4lidar::has_request(*model, of.setting->change)) {
    made.additional_constraints = "this model does not have it";
    return;
  }
  if (of.setting->type == g4lidar::setting_type::decimal) {
    std::uint16_t least_dhz = UINT16_MAX;
    std::uint16_t most_dhz = 0;
    for (const g4lidar::model& each : g4lidar::models) {
      const bool is_set = each.frequency.max_dhz != 0;
      if (!is_set || (model != nullptr && model != &each)) continue;
      least_dhz = std::min(least_dhz, each.frequency.min_dhz);
      most_dhz = std::max(most_dhz, each.frequency.max_dhz);
    }
    made.floating_point_range.resize(1);
    made.floating_point_range[0].from_value = least_dhz / 10.0;
    made.floating_point_range[0].to_value = most_dhz / 10.0;
    made.floating_point_range[0].step = of.range[2];
  } else if (of.setting->type == g4lidar::setting_type::whole && model != nullptr) {
    made.additional_constraints.clear();
    for (const g4lidar::sample_rate_entry& each : model->rates.entries) {
      if (each.hz == 0) break;
      if (!made.additional_constraints.empty()) made.additional_constraints += ", ";
      made.additional_constraints += std::to_string(each.hz);
    }
  } else if (of.setting->type == g4lidar::setting_type::whole) {
    made.additional_constraints += " of a G4; those of the model";
  }
}

/// A parameter of the lidar. Its type is that of the table, but 10 is also taken for 10.0, and true for "on".
void declare(rclcpp_lifecycle::LifecycleNode& node, const g4lidar::parameter& of,
             const g4lidar::model* model) {
  descriptor made;
  made.description = of.description;
  made.additional_constraints = of.constraints;
  made.dynamic_typing = true;
  if (of.kind == g4lidar::parameter_kind::read_only) made.additional_constraints = "read-only";
  if (of.setting != nullptr) {
    limit(made, of, model);
  } else if (const auto [least, most, step] = of.range; least < most) {
    made.floating_point_range.resize(1);
    made.floating_point_range[0].from_value = least;
    made.floating_point_range[0].to_value = most;
    made.floating_point_range[0].step = step;
  }
  node.declare_parameter(std::string(of.name), first_value(of), made);
}

g4lidar::parameter_value value_of(const rclcpp::Parameter& from) {
  switch (from.get_type()) {
    case rclcpp::PARAMETER_BOOL:
      return from.as_bool();
    case rclcpp::PARAMETER_INTEGER:
      return from.as_int();
    case rclcpp::PARAMETER_DOUBLE:
      return from.as_double();
    case rclcpp::PARAMETER_STRING:
      return from.as_string();
    default:
      return {};
  }
}

rclcpp::ParameterValue ros_value_of(const g4lidar::parameter_value& from) {
  return std::visit(
      [](const auto& value) {
        if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::monostate>)
          return rclcpp::ParameterValue();
        else
          return rclcpp::ParameterValue(value);
      },
      from);
}

/// Of a setting that is made when the lidar is opened. Throws std::invalid_argument.
void take_setting(g4lidar::lidar_options& options, const g4lidar::parameter& of,
                  const rclcpp::Parameter& wanted) {
  const auto made = g4lidar::answer_of(*of.setting, value_of(wanted));
  if (const auto* wrong = std::get_if<std::string>(&made))
    throw std::invalid_argument(wanted.get_name() + ": " + *wrong);
  g4lidar::set_option(options, std::get<g4lidar::answer>(made));
}

}  // namespace

node_parameters::node_parameters(rclcpp_lifecycle::LifecycleNode& node) : node_(node) {
  node.declare_parameter("source", "",
                         fixed("The lidar or the recording",
                               "empty: the only lidar; /dev/ttyUSB0, serial:NUMBER, "
                               "usb:PATH, tcp:HOST:PORT, a file, or sim:"));
  node.declare_parameter(
      "model", "",
      fixed("The model of the lidar",
            "empty: the lidar is searched, or that of a recording; " + g4lidar::model_words()));
  node.declare_parameter("baud", 0,
                         fixed_count("Bits per second; 0: those of the model", 0, 10'000'000));
  node.declare_parameter("frame_id", "laser", fixed("Frame of the scans"));
  node.declare_parameter("grid", 0,
                         fixed_count("Ranges of each LaserScan; 0: those of the model", 0, 65536));
  node.declare_parameter("order", "angle",
                         fixed("Order of the ranges of a LaserScan", "angle, time"));
  node.declare_parameter("base_frame", "base_link", fixed("Frame of the robot"));
  node.declare_parameter("odometry_frame", "odom", fixed("Frame of the odometry"));
  node.declare_parameter("mount", "",
                         fixed("Where the lidar is on the robot, for /tf_static and deskewing",
                               "X,Y,DEG or X,Y,DEG,down, in metres and degrees; empty: unknown"));
  node.declare_parameter(
      "deskew", "none",
      fixed("Deskew each revolution by the scans alone, by the recorded or subscribed odometry, or "
            "by tf from odometry_frame to base_frame",
            "none, scans, odometry, tf"));
  node.declare_parameter("playback_speed", 1.0,
                         fixed_number("Speed of a recording; 1: as recorded", 0.01, 100.0));
  node.declare_parameter("loop", false, fixed("Start a recording again at its end"));
  node.declare_parameter(
      "connect_timeout", 10.0,
      fixed_number("How long configure waits for the lidar, s; 0: it succeeds without the lidar, "
                   "which is used when it comes",
                   0.0, 3600.0));
  node.declare_parameter("autostart", false,
                         fixed("Whether the node configures and activates itself at the start"));
  descriptor standby;
  standby.description = "Whether the motor rests while nobody subscribes to a scan or a cloud";
  node.declare_parameter("standby", false, standby);
  node.declare_parameter(
      "mask", "",
      fixed("File of polygons: returns inside of them, parts of the robot, are left out"));
  const g4lidar::model* const model = g4lidar::model_named(node.get_parameter("model").as_string());
  for (const g4lidar::parameter& each : g4lidar::all_parameters()) {
    if (!node.has_parameter(std::string(each.name))) declare(node, each, model);
  }
  warn_about_unknown_ones();
  refusing_ = node.add_on_set_parameters_callback([this](const changes& wanted) {
    rcl_interfaces::msg::SetParametersResult made;
    made.reason = is_update_ ? "" : refuse(wanted);
    made.successful = made.reason.empty();
    return made;
  });
}

void node_parameters::warn_about_unknown_ones() const {
  for (const auto& [name, value] :
       node_.get_node_parameters_interface()->get_parameter_overrides()) {
    // Those with a dot belong to parts of ROS, which declare them later: qos_overrides./scan.publisher.depth.
    if (name.find('.') != std::string::npos || node_.has_parameter(name)) continue;
    RCLCPP_WARN(node_.get_logger(), "parameter '%s' is ignored: there is none of this name",
                name.c_str());
  }
}

void node_parameters::take_motion(session_options& into) const {
  motion_options& motion = into.motion;
  motion.base_frame = node_.get_parameter("base_frame").as_string();
  motion.odometry_frame = node_.get_parameter("odometry_frame").as_string();
  motion.is_turned = into.order == g4lidar::scan_order::time;
  if (const std::string text = node_.get_parameter("mount").as_string(); !text.empty()) {
    const auto place = g4lidar::mounting_in(text);
    if (const auto* wrong = std::get_if<std::string>(&place))
      throw std::invalid_argument("mount: " + *wrong);
    motion.mount = std::get<g4lidar::mounting>(place);
    into.shaping.mount = *motion.mount;
  }
  const std::string deskew = node_.get_parameter("deskew").as_string();
  constexpr std::array<std::string_view, 4> words{"none", "scans", "odometry", "tf"};
  const auto at = std::ranges::find(words, deskew);
  if (at == words.end())
    throw std::invalid_argument("deskew: '" + deskew + "' is not one of none, scans, odometry, tf");
  motion.from = static_cast<motion_source>(at - words.begin());
  if (motion.from == motion_source::none) return;
  if (motion.is_turned)
    throw std::invalid_argument(
        "order: time cannot be used with deskew: deskewed points have one time");
  into.shaping.deskew = motion.from == motion_source::scans ? g4lidar::deskewing::by_scans
                                                            : g4lidar::deskewing::by_path;
}

session_options node_parameters::for_session() const {
  for (const char* const name : {"connect_timeout", "playback_speed"}) {  // which ranges let pass
    if (std::isnan(node_.get_parameter(name).as_double()))
      throw std::invalid_argument(std::string(name) + ": it is not a number");
  }
  session_options made;
  g4lidar::lidar_options& lidar = made.lidar;
  lidar.device = node_.get_parameter("source").as_string();
  if (const std::string word = node_.get_parameter("model").as_string(); !word.empty()) {
    lidar.model = g4lidar::model_named(word);
    if (lidar.model == nullptr)
      throw std::invalid_argument("model: '" + word + "' is not one of " + g4lidar::model_words());
  }
  if (const auto baud = node_.get_parameter("baud").as_int(); baud > 0)
    lidar.baud = static_cast<std::uint32_t>(baud);
  lidar.reconnect = true;
  lidar.device_wait = std::chrono::milliseconds::max();
  lidar.playback.speed = node_.get_parameter("playback_speed").as_double();
  lidar.playback.loop = node_.get_parameter("loop").as_bool();
  made.frame_id = node_.get_parameter("frame_id").as_string();
  if (const auto bins = node_.get_parameter("grid").as_int(); bins > 0)
    made.bins = static_cast<std::uint32_t>(bins);
  const std::string order = node_.get_parameter("order").as_string();
  if (order != "angle" && order != "time")
    throw std::invalid_argument("order: '" + order + "' is not one of angle, time");
  if (order == "time") made.order = g4lidar::scan_order::time;
  take_motion(made);
  made.mask = node_.get_parameter("mask").as_string();
  made.shaping.restamps = true;  // nobody is to deskew the points of a message again
  for (const g4lidar::parameter& each : g4lidar::all_parameters()) {
    const rclcpp::Parameter wanted = node_.get_parameter(std::string(each.name));
    if (each.kind == g4lidar::parameter_kind::filter)
      made.filters.emplace_back(each.name, value_of(wanted));
    else if (each.setting != nullptr && wanted.get_type() != rclcpp::PARAMETER_NOT_SET)
      take_setting(lidar, each, wanted);
  }
  if (const auto wrong = g4lidar::problem_with(lidar))
    throw std::invalid_argument(wrong->message());
  return made;
}

void node_parameters::follow(std::shared_ptr<lidar_session> session) {
  session_ = std::move(session);
  update();
}

void node_parameters::update() {
  const g4lidar::lidar_parameters* const known = session_ ? session_->news() : nullptr;
  if (known == nullptr) return;
  is_update_ = true;
  for (const g4lidar::parameter& each : g4lidar::all_parameters()) {
    const g4lidar::parameter_value value = known->value(each);
    const bool is_of_lidar = each.setting != nullptr || each.name == "serial_number";
    if (is_of_lidar && value.index() != 0)
      node_.set_parameter({std::string(each.name), ros_value_of(value)});
  }
  is_update_ = false;
}

std::string node_parameters::refuse(const changes& wanted) {
  std::vector<g4lidar::named_value> values;
  for (const rclcpp::Parameter& each : wanted) {
    const g4lidar::parameter* const known = g4lidar::find_parameter(each.get_name());
    if (known != nullptr) values.emplace_back(each.get_name(), value_of(each));
  }
  if (values.empty()) return {};
  if (session_) return session_->change(std::move(values));
  // Nothing is open: only whether they can be used later.
  g4lidar::scan_shaper shaper;
  g4lidar::lidar_parameters trial({}, {}, {}, {}, shaper);
  for (const g4lidar::named_value& each : values) {
    const g4lidar::parameter* const known = g4lidar::find_parameter(each.first);
    if (known->setting == nullptr) {
      if (std::string wrong = trial.change(nullptr, {&each, 1}); !wrong.empty()) return wrong;
      continue;
    }
    const auto made = g4lidar::answer_of(*known->setting, each.second);
    if (const auto* wrong = std::get_if<std::string>(&made)) return each.first + ": " + *wrong;
  }
  return {};
}

std::chrono::nanoseconds node_parameters::connect_timeout() const {
  const std::chrono::duration<double> wait(node_.get_parameter("connect_timeout").as_double());
  return std::chrono::duration_cast<std::chrono::nanoseconds>(wait);
}

bool node_parameters::starts_itself() const { return node_.get_parameter("autostart").as_bool(); }

bool node_parameters::is_standby() const { return node_.get_parameter("standby").as_bool(); }

}  // namespace g4lidar_ros
