// SPDX-License-Identifier: MIT
#include "settings.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <variant>

#include "exit_code.hpp"
#include "logger.hpp"

namespace g4_tool {
namespace {

scan_frequency frequency_of(const std::string& word) {
  const double hz = number_of(word, min_scan_frequency_chz / 100.0, max_scan_frequency_chz / 100.0);
  const auto tenths = static_cast<std::uint16_t>(std::lround(hz * 10.0));
  if (std::abs(hz * 10.0 - tenths) > 1e-6) {
    throw bad_value(fmt::format("'{}' is not a multiple of 0.1, such as 7.5", word));
  }
  return scan_frequency{static_cast<std::uint16_t>(tenths * 10)};
}

request request_for_value(const answer& value) {
  return std::visit(
      [](const auto& wanted) -> request {
        if constexpr (requires { requests::set(wanted); }) {
          return requests::set(wanted);
        } else {
          return requests::device_info();  // no setting, and in no row of the table
        }
      },
      value);
}

}  // namespace

const std::vector<setting>& all_settings() {
  using enum sample_rate;
  using enum motor_direction;
  static const std::vector<setting> all{
      {"sample_rate",
       requests::get_sample_rate(),
       {{"4k", khz_4},
        {"8k", khz_8},
        {"9k", khz_9},
        {"4000", khz_4},
        {"8000", khz_8},
        {"9000", khz_9}}},
      {"freq", requests::get_scan_frequency(), {}},
      {"direction", requests::get_direction(), {{"cw", clockwise}, {"ccw", counter_clockwise}}},
      {"constant", {}, {{"on", constant_frequency::on}, {"off", constant_frequency::off}}},
      {"idle", requests::get_low_power(), {{"on", low_power::on}, {"off", low_power::off}}},
      {"protection", {}, {{"on", power_down_protection::on}, {"off", power_down_protection::off}}},
  };
  return all;
}

std::vector<std::string> example_wishes() {
  std::vector<std::string> wishes;
  for (const setting& each : all_settings()) {
    for (const auto& [word, value] : each.values) {
      wishes.push_back(fmt::format("{}={}", each.name, word));
    }
  }
  for (int hz = 5; hz <= 12; ++hz) wishes.push_back(fmt::format("freq={}", hz));
  return wishes;
}

bool is_wish(std::string_view word) noexcept {
  const std::size_t end =
      word.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz-_");
  return end != std::string_view::npos && end > 0 && word[end] == '=';
}

wish wish_of(const std::string& word) {
  const std::size_t equals = word.find('=');
  std::string name = word.substr(0, equals);
  if (name == "low-power" || name == "low_power")
    name = "idle";  // its name in earlier versions, and in Python
  choices<const setting*> names;
  for (const setting& each : all_settings()) names.emplace_back(each.name, &each);
  const setting* const which = choice_of(name, names);
  const std::string wanted = word.substr(equals + 1);
  try {
    const answer value =
        which->values.empty() ? answer(frequency_of(wanted)) : choice_of(wanted, which->values);
    return {which, request_for_value(value), value};
  } catch (const bad_value& reason) {
    throw bad_value(fmt::format("{}: {}", which->name, reason.what()));
  }
}

maybe_answer read_setting(g4lidar::lidar& lidar, const setting& which) {
  if (!which.question) return std::nullopt;
  const auto given = lidar.ask(*which.question);
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
  for (const setting& each : all_settings()) {
    for (const auto& [word, meaning] : each.values) {
      if (meaning == *value) return word;
    }
  }
  return "unknown";
}

nlohmann::ordered_json json_of(const maybe_answer& value) {
  std::string text = text_of(value);
  if (!value || text == "unknown") return nullptr;
  if (const auto* rate = std::get_if<sample_rate>(&*value)) return to_hz(*rate);
  if (const auto* frequency = std::get_if<scan_frequency>(&*value)) return frequency->chz / 100.0;
  if (std::holds_alternative<motor_direction>(*value)) return text;
  return text == "on";
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

}  // namespace g4_tool
