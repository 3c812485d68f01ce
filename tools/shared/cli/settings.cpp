// SPDX-License-Identifier: MIT
#include "settings.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>

#include "exit_code.hpp"
#include "logger.hpp"
#include "rows.hpp"

namespace g4_tool {
namespace {

/// The words for the values of a setting that has a few.
choices<answer> choices_of(const setting_info& which) {
  choices<answer> all;
  for (const setting_value& each : which.values) all.emplace_back(each.word, each.value);
  return all;
}

/// A multiple of the step of a decimal.
answer decimal_of(const setting_info& which, const std::string& word) {
  const double number = number_of(word, which.least / 100.0, which.most / 100.0);
  const double steps = number * 100.0 / which.step;
  const bool is_whole = std::abs(steps - std::round(steps)) <= 1e-6;
  const auto made = value_of(which, static_cast<std::int32_t>(std::lround(steps)) * which.step);
  if (!is_whole || !made) {
    throw bad_value(
        fmt::format("'{}' is not a multiple of {}, such as 7.5", word, which.step / 100.0));
  }
  return *made;
}

}  // namespace

std::string values_of(const setting_info& which) {
  if (which.values.empty()) return fmt::format("{}..{}", which.least / 100, which.most / 100);
  return words_of(choices_of(which), "|");
}

std::vector<std::string> example_changes() {
  std::vector<std::string> all;
  for (const setting_info& each : all_settings()) {
    for (const setting_value& value : each.values) {
      all.push_back(fmt::format("{}={}", each.name, value.word));
    }
    if (!each.values.empty()) continue;
    for (int n = each.least / 100; n <= each.most / 100; ++n) {
      all.push_back(fmt::format("{}={}", each.name, n));
    }
  }
  return all;
}

bool is_change(std::string_view word) noexcept {
  const std::size_t end =
      word.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz-_");
  return end != std::string_view::npos && end > 0 && word[end] == '=';
}

setting_change change_of(const std::string& word) {
  const std::size_t equals = word.find('=');
  choices<const setting_info*> names;
  for (const setting_info& each : all_settings()) names.emplace_back(each.name, &each);
  const setting_info& which = *choice_of(word.substr(0, equals), names);
  const std::string wanted = word.substr(equals + 1);
  for (const setting_value& each : which.values) {
    if (which.type == setting_type::whole && wanted == std::to_string(each.number)) {
      return {&which, each.value};
    }
  }
  try {
    return {&which, which.values.empty() ? decimal_of(which, wanted)
                                         : choice_of(wanted, choices_of(which))};
  } catch (const bad_value& reason) {
    throw bad_value(fmt::format("{}: {}", which.name, reason.what()));
  }
}

maybe_answer read_setting(g4lidar::lidar& lidar, const setting_info& which) {
  if (!which.query) return std::nullopt;
  const auto given = lidar.ask(*which.query);
  if (given) return *given;
  if (given.error().is_fatal()) throw failure(given.error());
  logger::verbose(in_tool_words(given.error().message()) + "\n");
  return std::nullopt;
}

std::string text_of(const maybe_answer& value) {
  if (!value) return "unknown";
  if (const auto* frequency = std::get_if<scan_frequency>(&*value)) {
    const bool is_even = frequency->chz % 10 == 0;
    return fmt::format("{:.{}f}", frequency->chz / 100.0, is_even ? 1 : 2);
  }
  const setting_value* const known = find_value(*value);
  return known == nullptr ? "unknown" : std::string(known->word);
}

nlohmann::ordered_json json_of(const maybe_answer& value) {
  const auto number = value ? number_of(*value) : std::nullopt;
  if (!number) return nullptr;
  switch (setting_of(*value)->type) {
    case setting_type::whole:
      return *number;
    case setting_type::decimal:
      return *number / 100.0;
    case setting_type::word:
      return text_of(value);
    case setting_type::on_off:
      break;
  }
  return text_of(value) == "on";
}

std::string firmware_of(const device_information& who) {
  return fmt::format("{}.{}", who.firmware_major, who.firmware_minor);
}

nlohmann::ordered_json json_of(const std::optional<device_information>& who) {
  if (!who) {
    return {{"model", nullptr}, {"serial", nullptr}, {"firmware", nullptr}, {"hardware", nullptr}};
  }
  return {{"model", who->model},
          {"serial", std::string(who->serial_number())},
          {"firmware", firmware_of(*who)},
          {"hardware", who->hardware}};
}

nlohmann::ordered_json json_of(std::span<const g4lidar::model* const> candidates) {
  if (candidates.empty()) return nullptr;
  auto words = nlohmann::ordered_json::array();
  for (const g4lidar::model* each : candidates) words.push_back(each->word);
  return {{"model", candidates.front()->word}, {"candidates", words}};
}

}  // namespace g4_tool
