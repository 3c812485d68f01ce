// SPDX-License-Identifier: MIT
#include "node_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string_view>
#include <tuple>
#include <utility>
#include <variant>

#include <rclcpp/version.h>

#include "g4lidar/options/filter_text.hpp"
#include "g4lidar/options/lidar_parameters.hpp"
#include "g4lidar/transport/source.hpp"
#include "parameter_declarations.hpp"

namespace g4lidar_ros {
namespace {

/// Of the names of lidars.
constexpr const char* name_characters =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_";

/// The text of the filter fov. Throws std::invalid_argument if two fields of view are given.
std::string field_of_view(const std::string& fov, double from, double to) {
  if (fov.empty()) return sector_text(from, to);
  if (from == -180.0 && to == 180.0) return fov;
  throw std::invalid_argument("fov: it cannot be used together with angle_min and angle_max");
}

bool is_direction(const std::string& name) {
  return name == "fov" || name == "angle_min" || name == "angle_max";
}

/// A filter or a setting of this name; else null.
const g4lidar::parameter* row_of(const std::string& name) {
  const g4lidar::parameter* const known = g4lidar::find_parameter(name);
  const bool is_one = known != nullptr &&
                      (known->setting != nullptr || known->kind == g4lidar::parameter_kind::filter);
  return is_one ? known : nullptr;
}

/// The number of the word that a parameter is. Throws std::invalid_argument if it is none.
std::size_t word_in(const rclcpp::Parameter& given) {
  const auto words = g4lidar::find_parameter(given.get_name())->words;
  const auto at = std::ranges::find(words, given.as_string());
  if (at != words.end()) return static_cast<std::size_t>(at - words.begin());
  const std::string all =
      g4lidar::limits_of(*g4lidar::find_parameter(given.get_name())).constraints;
  throw std::invalid_argument(given.get_name() + ": '" + given.as_string() + "' is not one of " +
                              all);
}

/// The mask in this file. Throws std::invalid_argument.
g4lidar::mask mask_in(const std::string& path) {
  auto made = g4lidar::load_mask(path);
  if (const auto* wrong = std::get_if<std::string>(&made)) throw std::invalid_argument(*wrong);
  return std::get<g4lidar::mask>(std::move(made));
}

/// The place of a lidar as a parameter gives it. Throws std::invalid_argument.
g4lidar::mounting place_in(const std::string& parameter, const std::string& text) {
  const auto place = g4lidar::mounting_in(text);
  if (const auto* wrong = std::get_if<std::string>(&place))
    throw std::invalid_argument(parameter + ": " + *wrong);
  return std::get<g4lidar::mounting>(place);
}

/// The names and the values of "NAME=VALUE" each. Throws std::invalid_argument.
std::vector<std::pair<std::string, std::string>> named_words(const rclcpp::Parameter& given) {
  std::vector<std::pair<std::string, std::string>> made;
  for (const std::string& word : given.as_string_array()) {
    const std::size_t end = word.find('=');
    const std::string name = word.substr(0, end);
    const bool is_name = name.find_first_not_of(name_characters) == std::string::npos;
    if (!word.empty() && (end == std::string::npos || name.empty() || !is_name))
      throw std::invalid_argument(given.get_name() + ": '" + word + "' is not NAME=VALUE");
    if (!word.empty()) made.emplace_back(name, word.substr(end + 1));
  }
  return made;
}

/// What the lidar is to be set to; nothing: to nothing. Throws std::invalid_argument with the possible values.
g4lidar::parameter_value wanted_in(const g4lidar::parameter& parameter,
                                   const rclcpp::Parameter& given) {
  if (given.get_parameter_value() == shown(parameter, {})) return {};
  const auto made = g4lidar::answer_of(*parameter.setting, value_of(given.get_parameter_value()));
  if (!made) throw std::invalid_argument(std::string(made.error().subject()));
  return g4lidar::value_of(*made);
}

}  // namespace

node_parameters::node_parameters(rclcpp_lifecycle::LifecycleNode& node) : node_(node) {
  declare_parameters(node);
  warn_about_unknown_ones();
#if RCLCPP_VERSION_GTE(21, 0, 0)
  converting_ = node.add_pre_set_parameters_callback([this](changes& wanted) { convert(wanted); });
#endif
  refusing_ = node.add_on_set_parameters_callback([this](const changes& wanted) {
    rcl_interfaces::msg::SetParametersResult made;
    if (is_update_) {
      made.successful = true;
      return made;
    }
#if !RCLCPP_VERSION_GTE(21, 0, 0)
    // Humble has nothing that is called before. It keeps these values, in its own copy.
    convert(const_cast<changes&>(wanted));  // NOLINT(cppcoreguidelines-pro-type-const-cast)
#endif
    try {
      made.reason = refuse(wanted);
    } catch (const std::invalid_argument& wrong) {
      made.reason = wrong.what();
    }
    made.successful = made.reason.empty();
    return made;
  });
}

void node_parameters::convert(changes& wanted) const {
  for (rclcpp::Parameter& each : wanted) {
    const std::string name = each.get_name();
    if (row_of(name) != nullptr || is_direction(name) || name == "standby")
      each = {name, converted(each.get_parameter_value(), node_.get_parameter(name).get_type())};
  }
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
  motion.base_frame = text("base_frame");
  motion.odometry_frame = text("odometry_frame");
  motion.is_turned = into.order == g4lidar::scan_order::time;
  if (into.lidars.size() == 1) motion.mount = into.lidars.front().mount;
  motion.from = static_cast<motion_source>(word_in(node_.get_parameter("deskew")));
  if (motion.from == motion_source::none) return;
  if (motion.is_turned)
    throw std::invalid_argument(
        "order: time cannot be used with deskew: deskewed points have one time");
  into.service.deskew = motion.from == motion_source::scans ? g4lidar::deskewing::by_scans
                                                            : g4lidar::deskewing::by_path;
  into.service.other_odometry_place =
      motion.from == motion_source::tf
          ? "from " + motion.odometry_frame + " to " + motion.base_frame + " in tf"
          : "on " + node_.get_node_topics_interface()->resolve_topic_name("odom");
}

void node_parameters::take_opening(g4lidar::lidar_options& into) const {
  for (const g4lidar::parameter& each : g4lidar::all_parameters()) {
    const bool is_opening = each.access != nullptr && each.setting == nullptr;
    if (!is_opening || !each.is_of(g4lidar::option_door::node)) continue;
    const rclcpp::ParameterValue given = node_.get_parameter(node_name(each)).get_parameter_value();
    if (given == first_value(each)) continue;  // not given
    const std::string wrong = g4lidar::set_option(into, each, value_of(given));
    if (!wrong.empty()) throw std::invalid_argument(node_name(each) + ": " + wrong);
  }
  g4lidar::lidar_options of_source = into;
  of_source.playback = {};  // those of a lidar are ignored
  if (const auto wrong = g4lidar::problem_with_source(of_source))
    throw std::invalid_argument(wrong->message());
  if (into.playback.speed == 0) into.playback.speed = 1;
  into.reconnect = true;
  into.device_wait = connect_timeout();
  into.is_cancelled = [of = node_.get_node_base_interface()->get_context()] {
    return !of->is_valid();
  };
}

std::vector<g4lidar::service_lidar> node_parameters::lidars() const {
  const auto sources = named_words(node_.get_parameter("sources"));
  std::vector<g4lidar::service_lidar> made(std::max<std::size_t>(1, sources.size()));
  made.front().options.device = text("source");
  for (std::size_t i = 0; i < sources.size(); ++i) {
    std::tie(made[i].name, made[i].options.device) = sources[i];
    if (g4lidar::names_file(made[i].options.device))
      throw std::invalid_argument("sources: a file cannot be merged, as it has its own clock");
  }
  const bool is_single = !text("source").empty() || !text("mount").empty() || sources.size() == 1;
  if (!sources.empty() && (is_single || text("order") == "time"))
    throw std::invalid_argument(
        "sources: two lidars or more, and without source, mount and order: time");
  if (!text("mount").empty()) made.front().mount = place_in("mount", text("mount"));
  for (const auto& [name, place] : named_words(node_.get_parameter("mounts"))) {
    const auto lidar = std::ranges::find(made, name, &g4lidar::service_lidar::name);
    if (lidar == made.end())
      throw std::invalid_argument("mounts: there is no '" + name + "' in sources");
    lidar->mount = place_in("mounts", place);
  }
  for (g4lidar::service_lidar& each : made) take_opening(each.options);
  return made;
}

session_options node_parameters::for_session() const {
  if (std::isnan(node_.get_parameter("connect_timeout").as_double()))  // a range lets it pass
    throw std::invalid_argument("connect_timeout: it is not a number");
  session_options made;
  made.lidars = lidars();
  made.frame_id = text(made.lidars.size() == 1 ? "frame_id" : "base_frame");
  if (const auto bins = node_.get_parameter("grid").as_int(); bins > 0)
    made.bins = static_cast<std::uint32_t>(bins);
  made.order = static_cast<g4lidar::scan_order>(word_in(node_.get_parameter("order")));
  take_motion(made);
  made.service.mask = mask_in(text("mask"));
  made.service.filters.filter.in = g4lidar::frame::robot;
  made.service.restamps = true;  // nobody is to deskew the points of a message again
  made.service.reads_settings = true;
  made.service.is_standby = true;
  made.filters = filters({});
  for (const g4lidar::parameter& each : g4lidar::all_parameters()) {
    if (each.setting == nullptr) continue;
    const std::string name(each.name);
    const auto value = wanted_in(each, node_.get_parameter(name));
    if (value.index() == 0) continue;
    for (g4lidar::service_lidar& lidar : made.lidars) {
      static_cast<void>(g4lidar::set_option(lidar.options, each, value));
      lidar.settings.emplace_back(name, value);
    }
  }
  for (g4lidar::service_lidar& each : made.lidars) {
    if (const auto wrong = g4lidar::problem_with(each.options))
      throw std::invalid_argument(wrong->message());
    // Files of parameters have settings for every source.
    if (g4lidar::names_file(each.options.device)) each.settings.clear();
    each.options = g4lidar::usable_options(each.options);
  }
  return made;
}

void node_parameters::follow(std::shared_ptr<lidar_session> session) {
  session_ = std::move(session);
  update(true);
}

void node_parameters::update(bool is_news) {
  if (!is_news && !(session_ && session_->has_news())) return;
  is_update_ = true;
  for (const g4lidar::parameter& each : g4lidar::all_parameters()) {
    if (!has_state(each)) continue;
    const auto known = session_ ? session_->known(each) : g4lidar::parameter_value();
    node_.set_parameter({std::string(state_prefix).append(each.name), shown(each, known)});
  }
  is_update_ = false;
}

std::vector<g4lidar::named_value> node_parameters::filters(const changes& wanted) const {
  const auto value = [&](const std::string& name) {
    const auto at = std::ranges::find(wanted, name, &rclcpp::Parameter::get_name);
    return at != wanted.end() ? *at : node_.get_parameter(name);
  };
  std::vector<g4lidar::named_value> found;
  for (const g4lidar::parameter& each : g4lidar::all_parameters()) {
    const std::string name(each.name);
    if (each.kind == g4lidar::parameter_kind::filter && each.is_of(g4lidar::option_door::node))
      found.emplace_back(name, value_of(value(name).get_parameter_value()));
    if (name == "fov")
      found.back().second = field_of_view(value(name).as_string(), value("angle_min").as_double(),
                                          value("angle_max").as_double());
  }
  return found;
}

std::string node_parameters::refuse(const changes& wanted) {
  std::vector<g4lidar::named_value> settings;
  std::vector<std::string> touched;  // the filters
  for (const rclcpp::Parameter& each : wanted) {
    const std::string& name = each.get_name();
    if (name.starts_with(state_prefix)) return name + ": only the lidar changes it";
    if (!node_.has_parameter(name)) continue;
    const auto type = node_.get_parameter(name).get_type();
    if (each.get_type() != type)
      return name + ": it is a " + rclcpp::to_string(type) + ", and not a " + each.get_type_name();
    const g4lidar::parameter* const known = row_of(name);
    if (known != nullptr && known->setting != nullptr)
      settings.emplace_back(name, wanted_in(*known, each));
    else if (known != nullptr || is_direction(name))
      touched.push_back(is_direction(name) ? "fov" : name);
  }
  // One that is no longer wanted stays as it is.
  std::erase_if(settings, [](const auto& each) { return each.second.index() == 0; });
  std::vector<g4lidar::named_value> values;
  if (!touched.empty()) values = filters(wanted);
  std::erase_if(values, [&](const auto& each) {
    return std::ranges::find(touched, each.first) == touched.end();
  });
  if (session_) {
    values.insert(values.end(), settings.begin(), settings.end());
    return session_->change(values);
  }
  g4lidar::lidar_parameters trial;
  return trial.change(nullptr, values);
}

std::chrono::milliseconds node_parameters::connect_timeout() const {
  const std::chrono::duration<double> wait(node_.get_parameter("connect_timeout").as_double());
  if (wait.count() == 0) return std::chrono::milliseconds::max();
  return std::chrono::duration_cast<std::chrono::milliseconds>(wait);
}

}  // namespace g4lidar_ros
