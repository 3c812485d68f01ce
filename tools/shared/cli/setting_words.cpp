// SPDX-License-Identifier: MIT
#include "setting_words.hpp"

#include <fmt/format.h>

#include <optional>
#include <string_view>
#include <type_traits>
#include <variant>

#include "exit_code.hpp"
#include "g4lidar/core/request.hpp"
#include "g4lidar/options/lidar_parameters.hpp"
#include "logger.hpp"
#include "option_rows.hpp"

namespace g4_tool {
namespace {

/// The words for the values of a setting that has a few.
std::vector<std::string> value_words(const setting_info& which) {
  std::vector<std::string> all;
  for (const setting_value& each : which.values) all.emplace_back(each.word);
  return all;
}

}  // namespace

std::string values_of(const setting_info& which) {
  if (which.values.empty()) return fmt::format("{}..{}", which.least / 100, which.most / 100);
  return fmt::format("{}", fmt::join(value_words(which), "|"));
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

setting_change change_of(const std::string& word, const g4lidar::model* model) {
  const std::size_t equals = word.find('=');
  choices<const setting_info*> names;
  for (const setting_info& each : all_settings()) names.emplace_back(each.name, &each);
  const setting_info& which = *choice_of(word.substr(0, equals), names);
  const std::string wanted = word.substr(equals + 1);
  const auto value = value_in(which, wanted, model);
  if (value) return {&which, *value};
  if (model != nullptr && !has_request(*model, which.change)) {
    throw bad_value(
        fmt::format("{}: {} {} has no such setting", which.name, article_of(*model), model->name));
  }
  throw bad_value(std::string(value.error().subject()) + did_you_mean(wanted, value_words(which)));
}

maybe_answer read_setting(g4lidar::lidar& lidar, const setting_info& setting) {
  if (!setting.query) return std::nullopt;
  const auto given = lidar.ask(*setting.query);
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
  return json_of(value ? g4lidar::value_of(*value) : parameter_value());
}

nlohmann::ordered_json json_of(const parameter_value& value) {
  return std::visit(
      [](const auto& known) -> nlohmann::ordered_json {
        if constexpr (std::is_same_v<decltype(known), const std::monostate&>)
          return nullptr;
        else
          return known;
      },
      value);
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
