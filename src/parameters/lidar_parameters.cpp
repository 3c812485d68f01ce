// SPDX-License-Identifier: MIT
#include "g4lidar/lidar_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/number_text.hpp"
#include "g4lidar/core/session/model_requests.hpp"

namespace g4lidar {
namespace {

constexpr std::uint8_t is_bool = 1;
constexpr std::uint8_t is_integer = 2;
constexpr std::uint8_t is_double = 3;
constexpr std::uint8_t is_string = 4;

/// Nobody writes a longer value.
constexpr std::size_t longest_text = 100;

/// As a person writes it.
std::string word_of(const parameter_value& value) {
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "on" : "off";
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return std::to_string(*whole);
  if (const auto* number = std::get_if<double>(&value)) return text_of_number(*number);
  const auto* const text = std::get_if<std::string>(&value);
  return text != nullptr ? *text : std::string();
}

std::optional<double> number_of(const parameter_value& from) {
  if (const auto* whole = std::get_if<std::int64_t>(&from)) return static_cast<double>(*whole);
  if (const auto* number = std::get_if<double>(&from)) return *number;
  const auto* const text = std::get_if<std::string>(&from);
  constexpr double most = std::numeric_limits<double>::max();
  const auto made = number_in(text != nullptr ? *text : "", -most, most);
  return made ? std::optional(*made) : std::nullopt;
}

/// "on" is true in the YAML of ROS, and "nan" and "inf" are numbers there.
parameter_value text_of(const parameter_value& from) {
  const auto* const text = std::get_if<std::string>(&from);
  if (text != nullptr && (*text == "true" || *text == "false"))
    return std::string(*text == "true" ? "on" : "off");
  const auto* const number = std::get_if<double>(&from);
  const bool has_word = from.index() == is_bool || (number != nullptr && !std::isfinite(*number));
  if (has_word) return word_of(from);
  return text != nullptr ? from : parameter_value();
}

/// The value for a parameter, or why not.
text_result<parameter_value> value_for(const parameter& to, const parameter_value& from) {
  constexpr std::array<std::string_view, 5> types{"not set", "a bool", "an integer", "a double",
                                                  "a string"};
  parameter_value made = converted(from, to.type);
  if (made.index() != to.type)
    return tl::unexpected(std::string(to.name) + ": it is " + std::string(types.at(to.type)));
  const auto* const text = std::get_if<std::string>(&made);
  if (text != nullptr && text->size() > longest_text)
    return tl::unexpected(std::string(to.name) + ": the text is too long");
  return made;
}

parameter parameter_of(const setting_info& which) {
  constexpr std::array types{is_integer, is_double, is_string, is_bool};
  parameter made{which.name, types.at(static_cast<std::size_t>(which.type)), parameter_kind::device,
                 std::string(which.text), which.query ? "" : "known when it was set"};
  made.setting = &which;
  if (!which.unit.empty()) made.description.append(", ").append(which.unit);
  if (which.type == setting_type::decimal) {
    made.constraints = "multiples of " + text_of_number(which.step / 100.0);
    made.range = {which.least / 100.0, which.most / 100.0, which.step / 100.0};
  } else if (which.type == setting_type::whole) {
    made.constraints = list_of(
        which.values, [](const setting_value& each) { return std::to_string(each.number); });
  } else if (which.type == setting_type::word) {
    made.constraints = list_of(which.values, &setting_value::word);
  }
  return made;
}

}  // namespace

parameter limited_to(const model& which, const parameter& of) {
  parameter made = of;
  if (of.setting == nullptr) return made;
  if (!has_request(which, of.setting->change)) {
    made.constraints = "this model does not have it";
    const bool is_speed = of.setting->change == request_kind::set_scan_frequency;
    if (is_speed) made.constraints += "; its speed: " + speed_without_commands(which);
    made.range = {};
  } else if (of.setting->type == setting_type::decimal) {
    made.range = {which.frequency.min_dhz / 10.0, which.frequency.max_dhz / 10.0, of.range[2]};
  } else if (of.setting->type == setting_type::whole) {
    made.constraints = list_of(std::span(which.rates.entries).first(rate_count(which)),
                               [](const auto& rate) { return std::to_string(rate.hz); });
  }
  return made;
}

parameter_value converted(const parameter_value& from, std::uint8_t type) {
  if (type == is_string) return text_of(from);
  if (from.index() == type) return from;
  if (type == is_bool) {
    const std::string word = word_of(text_of(from));
    if (word != "on" && word != "off") return {};
    return word == "on";
  }
  const auto number = number_of(from);
  if (!number) return {};
  if (type == is_double) return *number;
  constexpr double largest = 1e15;  // each whole number below is a double
  const bool is_whole = std::trunc(*number) == *number && std::abs(*number) < largest;
  if (type != is_integer || !is_whole) return {};
  return static_cast<std::int64_t>(*number);
}

parameter_value value_of(const answer& given) {
  const setting_info* const of = setting_of(given);
  const auto number = number_of(given);
  if (of == nullptr || !number) return {};
  if (of->type == setting_type::on_off) return *number == 2;
  if (of->type == setting_type::whole) return std::int64_t{*number};
  if (of->type == setting_type::decimal) return *number / 100.0;
  const setting_value* const word = find_value(given);
  return word == nullptr ? parameter_value() : std::string(word->word);
}

result<answer> answer_of(const setting_info& of, const parameter_value& wanted,
                         const model* which) {
  return value_in(of, word_of(wanted), which);
}

std::span<const parameter> all_parameters() {
  using enum parameter_kind;
  static const std::vector<parameter> all = [] {
    std::vector<parameter> made{
        {"edges", is_string, filter, "Leave out veiling points at jumps of the range",
         "off, on, or limits as --edges"},
        {"fov", is_string, filter, "Directions that are kept, degrees in the frame of the robot",
         "FROM:TO, such as -90:90"},
        {"frame_id", is_string, read_only, "Frame of the scans", ""},
        {"grid", is_integer, read_only, "Ranges of each LaserScan", ""},
        {"ignore", is_string, filter, "Directions that are left out, as fov",
         "several with spaces between them: 30:40 90:100; off: none"},
        {"model", is_string, read_only, "Model of the lidar", "a word as that of --model"},
        {"near", is_string, filter,
         "Flag directions where something may be too near for a return: in a LaserScan as near_as",
         "off, on, or limits as --near"},
        {"near_as", is_string, filter, "What ranges in directions that near flags become",
         "nan, minus-inf"},
        {"no_return", is_string, filter,
         "What ranges without return become, which are not free space", "inf, nan, max"},
        {"order", is_string, read_only, "Order of the ranges of a LaserScan", "angle, time"},
        {"range_max", is_double, filter, "Longest range that is kept, m", "", {0.0, 100.0, 0.0}},
        {"range_min", is_double, filter, "Shortest range that is kept, m", "", {0.0, 100.0, 0.0}},
        {"serial_number", is_string, read_only, "Serial number of the lidar", ""},
        {"speckle", is_string, filter, "Leave out returns without another one near them",
         "off, on, or limits as --speckle"}};
    for (const setting_info& each : all_settings()) made.push_back(parameter_of(each));
    std::ranges::sort(made, {}, &parameter::name);
    return made;
  }();
  return all;
}

const parameter* find_parameter(std::string_view name) {
  const auto all = all_parameters();
  const auto at = std::ranges::find(all, name, &parameter::name);
  return at == all.end() ? nullptr : &*at;
}

lidar_parameters::lidar_parameters(const shaping_options& how, filter_settings start,
                                   g4lidar::mask mask, scan_shaper& shaper)
    : how_(how), mask_(std::move(mask)), shaper_(shaper), now_(std::move(start)) {
  shape();
  const point_filter& filter = now_.filter;
  fix("range_min", static_cast<double>(filter.least_range_mm) / 1e3);
  fix("range_max", std::min(static_cast<double>(filter.greatest_range_mm) / 1e3, 100.0));
}

void lidar_parameters::shape() {
  now_.grid.longest_mm = now_.filter.greatest_range_mm;
  how_.filter = now_.filter;
  how_.filter.ignored_sectors = now_.ignored;
  how_.filter.masks = mask_.polygons();
  how_.marks = now_.marks;
  shaper_.set_options(how_);
}

filter_settings lidar_parameters::current_filters() const {
  const std::lock_guard lock(mutex_);
  return now_;
}

void lidar_parameters::fix(std::string_view name, parameter_value value) {
  const std::lock_guard lock(mutex_);
  values_.insert_or_assign(std::string(name), std::move(value));
}

parameter_value lidar_parameters::value(const parameter& of) const {
  const std::lock_guard lock(mutex_);
  const auto at = values_.find(of.name);
  return at == values_.end() ? parameter_value() : at->second;
}

const model* lidar_parameters::known_model() const {
  const parameter_value known = value(*find_parameter("model"));
  const auto* const word = std::get_if<std::string>(&known);
  return word != nullptr ? model_named(*word) : nullptr;
}

parameter lidar_parameters::row(const parameter& of) const {
  const model* const which = known_model();
  return which != nullptr ? limited_to(*which, of) : of;
}

void lidar_parameters::read_device(lidar& device) {
  for (const parameter& each : all_parameters()) {
    if (each.setting == nullptr || !each.setting->query) continue;
    const auto given = device.ask(*each.setting->query);
    if (given)
      fix(each.name, value_of(*given));
    else if (given.error().is_fatal())
      return;  // the next read of the lidar finds it
  }
}

std::string lidar_parameters::set_device(lidar* device, std::span<const device_change> changes) {
  if (!changes.empty() && device == nullptr) return "the lidar is not connected";
  std::vector<std::pair<const parameter*, parameter_value>> before;
  for (const auto& [known, wanted] : changes) {
    const auto given = device->ask(change_to(wanted), while_scanning::stop_and_resume);
    if (given) {
      before.emplace_back(known, value(*known));
      fix(known->name, value_of(*given));
      continue;
    }
    for (const auto& [earlier, old] : before) {
      const auto back = answer_of(*earlier->setting, old);
      if (!back) continue;  // was not known
      if (device->ask(change_to(*back), while_scanning::stop_and_resume)) fix(earlier->name, old);
    }
    return given.error().message();
  }
  return {};
}

std::string lidar_parameters::change(lidar* device, std::span<const named_value> wanted) {
  std::map<std::string_view, parameter_value> values;  // of the filters
  std::vector<device_change> changes;
  filter_settings next = now_;
  for (const auto& [name, given] : wanted) {
    const parameter* const known = find_parameter(name);
    if (known == nullptr) return "there is no such parameter";
    if (known->kind == parameter_kind::read_only)
      return std::string(known->name) + ": it cannot change while the program runs";
    const auto value = value_for(*known, given);
    if (!value) return value.error();
    if (known->kind == parameter_kind::filter) {
      values[known->name] = *value;
      continue;
    }
    const auto change = answer_of(*known->setting, *value, known_model());
    if (!change) return std::string(change.error().subject());
    changes.emplace_back(known, *change);
  }
  for (const auto& [name, one] : values) {
    if (name.starts_with("range_")) continue;
    const std::string wrong = set_filter(next, name, word_of(one));
    if (!wrong.empty()) return std::string(name) + ": " + wrong;
  }
  if (values.contains("range_min") || values.contains("range_max")) {
    for (const std::string_view name : {"range_min", "range_max"}) {
      values.try_emplace(name, value(*find_parameter(name)));
    }
    const std::string wrong = set_filter(
        next, "range", word_of(values["range_min"]) + ":" + word_of(values["range_max"]));
    if (!wrong.empty()) return "range_min, range_max: " + wrong;
  }
  if (std::string reason = set_device(device, changes); !reason.empty()) return reason;
  if (values.empty()) return {};
  {
    const std::lock_guard lock(mutex_);
    now_ = std::move(next);
    shape();
  }
  for (const auto& [name, value] : values) fix(name, value);
  return {};
}

}  // namespace g4lidar
