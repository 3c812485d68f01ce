// SPDX-License-Identifier: MIT
#include "parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "cli/exit_code.hpp"
#include "cli/settings.hpp"
#include "io/shape_files.hpp"

namespace g4_tool {
namespace {

constexpr std::uint8_t is_bool = 1;
constexpr std::uint8_t is_integer = 2;
constexpr std::uint8_t is_double = 3;
constexpr std::uint8_t is_string = 4;

/// Nobody writes a longer value.
constexpr std::size_t longest_text = 100;

std::string_view name_of_type(std::size_t type) {
  constexpr std::array<std::string_view, 5> names{"not set", "a bool", "an integer", "a double",
                                                  "a string"};
  return names.at(type);
}

/// As a person writes it.
std::string word_of(const parameter_value& value) {
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "on" : "off";
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return std::to_string(*whole);
  if (const auto* number = std::get_if<double>(&value)) return fmt::format("{}", *number);
  const auto* const text = std::get_if<std::string>(&value);
  return text != nullptr ? *text : std::string();
}

/// A whole number is a double, too. Throws bad_value for another type.
parameter_value converted(const parameter& to, const parameter_value& from) {
  const auto* const whole = std::get_if<std::int64_t>(&from);
  if (to.type == is_double && whole != nullptr) return static_cast<double>(*whole);
  // "on" is true in the YAML of `ros2 param`.
  if (to.type == is_string && from.index() == is_bool) return word_of(from);
  if (from.index() != to.type) {
    throw bad_value(fmt::format("{}: it is {}", to.name, name_of_type(to.type)));
  }
  const auto* const text = std::get_if<std::string>(&from);
  if (text != nullptr && text->size() > longest_text) {
    throw bad_value(fmt::format("{}: the text is too long", to.name));
  }
  return from;
}

parameter_value value_of(const maybe_answer& given) {
  const auto json = json_of(given);
  if (json.is_boolean()) return json.get<bool>();
  if (json.is_string()) return json.get<std::string>();
  if (json.is_number_float()) return json.get<double>();
  if (json.is_number()) return json.get<std::int64_t>();
  return {};
}

parameter parameter_of(const setting_info& which) {
  constexpr std::array types{is_integer, is_double, is_string, is_bool};
  parameter made{which.name, types.at(static_cast<std::size_t>(which.type)), parameter_kind::device,
                 std::string(which.text), which.query ? "" : "known when it was set"};
  made.setting = &which;
  if (!which.unit.empty()) made.description.append(", ").append(which.unit);
  if (which.type == setting_type::decimal) {
    made.constraints = fmt::format("multiples of {}", which.step / 100.0);
    made.range = {which.least / 100.0, which.most / 100.0, which.step / 100.0};
  } else if (which.type != setting_type::on_off) {
    const bool is_whole = which.type == setting_type::whole;
    for (const setting_value& each : which.values) {
      made.constraints.append(made.constraints.empty() ? "" : ", ");
      made.constraints.append(is_whole ? std::to_string(each.number) : std::string(each.word));
    }
  }
  return made;
}

/// Sets an option of the command line by its parser. Throws bad_value.
void take_option(common_options& into, std::string_view option, const std::string& word) {
  option_rows rows = joined(filter_rows(into), near_row(into.marks.near), grid_rows(into.grid));
  const auto row = std::ranges::find(rows, option, &option_row::names);
  if (row != rows.end()) row->take(word);
}

/// Sets a filter of one text. Throws bad_value.
void set_filter(common_options& into, std::string_view name, const std::string& word) {
  if (name == "fov") return take_option(into, "--fov", word);
  if (name == "no_return") return take_option(into, "--no-return", word);
  if (name == "near_as") return take_option(into, "--near-as", word);
  const bool is_off = word.empty() || word == "off";
  if (name == "ignore") {
    into.ignored.clear();
    std::istringstream all(is_off ? "" : word);
    for (std::string one; all >> one;) take_option(into, "--ignore", one);
    return;
  }
  if (name == "speckle") into.marks.speckle.reset();
  if (name == "edges") into.marks.edges.reset();
  if (name == "near") into.marks.near.reset();
  if (!is_off) take_option(into, "--" + std::string(name), word == "on" ? "" : word);
}

}  // namespace

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

lidar_parameters::lidar_parameters(const common_options& how,
                                   const std::map<std::string, std::string>& words, bool merges,
                                   scan_shaper& shaper)
    : how_(how), merges_(merges), mask_(load_mask(how.mask)), shaper_(shaper) {
  shape_by(how);
  const point_filter& filter = how.filter;
  keep("range_min", static_cast<double>(filter.least_range_mm) / 1e3);
  keep("range_max", std::min(static_cast<double>(filter.greatest_range_mm) / 1e3, 100.0));
  for (const auto& [name, word] : words) keep(name, word);
}

void lidar_parameters::shape_by(const common_options& how) {
  shaping_options shape = shape_of(how, mask_);
  shape.for_merging = merges_;
  shape.restamps = true;  // nobody is to deskew the points of a message again
  shaper_.set_options(shape);
}

void lidar_parameters::keep(std::string_view name, parameter_value value) {
  const std::lock_guard lock(mutex_);
  values_.insert_or_assign(std::string(name), std::move(value));
}

void lidar_parameters::fix(std::string_view name, parameter_value value) {
  keep(name, std::move(value));
}

parameter_value lidar_parameters::value(const parameter& of) const {
  const std::lock_guard lock(mutex_);
  const auto at = values_.find(of.name);
  return at == values_.end() ? parameter_value() : at->second;
}

void lidar_parameters::read_device(g4lidar::lidar& device) {
  for (const parameter& each : all_parameters()) {
    if (each.setting == nullptr || !each.setting->query) continue;
    const auto given = device.ask(*each.setting->query);
    if (given)
      keep(each.name, value_of(maybe_answer(*given)));
    else if (given.error().is_fatal())
      return;  // the next read of the lidar finds it
  }
}

std::string lidar_parameters::set_device(g4lidar::lidar* device,
                                         std::span<const device_change> changes) {
  if (!changes.empty() && device == nullptr) return "the lidar is not connected";
  std::vector<std::pair<const parameter*, parameter_value>> before;
  for (const auto& [known, change] : changes) {
    const auto given = device->ask(change_to(change.value), while_scanning::stop_and_resume);
    if (given) {
      before.emplace_back(known, value(*known));
      keep(known->name, value_of(maybe_answer(*given)));
      continue;
    }
    for (const auto& [earlier, old] : before) {
      if (old.index() == 0) continue;  // was not known
      const setting_change back = change_of(fmt::format("{}={}", earlier->name, word_of(old)));
      if (device->ask(change_to(back.value), while_scanning::stop_and_resume))
        keep(earlier->name, old);
    }
    return in_tool_words(given.error().message());
  }
  return {};
}

std::string lidar_parameters::change(g4lidar::lidar* device, std::span<const named_value> wanted) {
  std::map<std::string_view, parameter_value> values;  // of the filters
  std::vector<device_change> changes;
  common_options next = how_;
  try {
    for (const auto& [name, given] : wanted) {
      const parameter* const known = find_parameter(name);
      if (known == nullptr) throw bad_value("there is no such parameter");
      if (known->kind == parameter_kind::read_only) {
        throw bad_value(fmt::format("{}: it cannot change while the program runs", known->name));
      }
      const parameter_value value = converted(*known, given);
      if (known->kind == parameter_kind::filter) {
        values[known->name] = value;
      } else {
        changes.emplace_back(known, change_of(fmt::format("{}={}", known->name, word_of(value))));
      }
    }
    for (const auto& [name, one] : values) {
      if (!name.starts_with("range_")) set_filter(next, name, word_of(one));
    }
    if (values.contains("range_min") || values.contains("range_max")) {
      for (const std::string_view name : {"range_min", "range_max"}) {
        values.try_emplace(name, value(*find_parameter(name)));
      }
      take_option(next, "--range",
                  word_of(values["range_min"]) + ":" + word_of(values["range_max"]));
    }
  } catch (const bad_value& reason) {
    return reason.what();
  }
  if (std::string reason = set_device(device, changes); !reason.empty()) return reason;
  if (!values.empty()) {
    shape_by(next);
    how_ = next;
    for (const auto& [name, value] : values) keep(name, value);
  }
  return {};
}

}  // namespace g4_tool
