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
#include "g4lidar/filter_text.hpp"
#include "g4lidar/lidar_parameters.hpp"
#include "g4lidar/setting_table.hpp"
#include "parameter_declarations.hpp"

namespace g4lidar_ros {
namespace {

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

}  // namespace

node_parameters::node_parameters(rclcpp_lifecycle::LifecycleNode& node) : node_(node) {
  declare_parameters(node);
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
  made.filters = filters();
  for (const g4lidar::parameter& each : g4lidar::all_parameters()) {
    const rclcpp::Parameter wanted = node_.get_parameter(std::string(each.name));
    if (each.setting == nullptr || wanted.get_type() == rclcpp::PARAMETER_NOT_SET) continue;
    const auto setting = g4lidar::answer_of(*each.setting, value_of(wanted));
    if (!setting) throw std::invalid_argument(std::string(setting.error().subject()));
    g4lidar::set_option(lidar, *setting);
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

std::vector<g4lidar::named_value> node_parameters::filters() const {
  std::vector<g4lidar::named_value> found;
  for (const g4lidar::parameter& each : g4lidar::all_parameters()) {
    if (each.kind == g4lidar::parameter_kind::filter)
      found.emplace_back(each.name, value_of(node_.get_parameter(std::string(each.name))));
  }
  return found;
}

std::string node_parameters::refuse_while_searching(
    const std::vector<g4lidar::named_value>& wanted) const {
  g4lidar::scan_shaper shaper;
  g4lidar::lidar_parameters trial({}, {}, {}, {}, shaper);
  if (std::string wrong = trial.change(nullptr, filters()); !wrong.empty()) return wrong;
  return trial.change(nullptr, wanted);
}

std::string node_parameters::refuse(const changes& wanted) {
  std::vector<g4lidar::named_value> values;
  for (const rclcpp::Parameter& each : wanted) {
    const g4lidar::parameter* const known = g4lidar::find_parameter(each.get_name());
    if (known != nullptr) values.emplace_back(each.get_name(), value_of(each));
  }
  if (values.empty()) return {};
  if (session_) {
    if (auto answered = session_->change(values)) return *std::move(answered);
    std::string wrong = refuse_while_searching(values);
    if (wrong.empty()) session_->change_later(std::move(values));
    return wrong;
  }
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
    if (!made) return std::string(made.error().subject());
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
