// SPDX-License-Identifier: MIT
#include "settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <variant>

#include "exit_code.hpp"
#include "file_id.hpp"
#include "manners.hpp"
#include "values.hpp"

namespace g4_dump {
namespace {

using namespace g4lidar;

const std::map<std::string, setting>& names() {
  static const std::map<std::string, setting> known{{"rate", setting::rate},
                                                    {"freq", setting::freq},
                                                    {"direction", setting::direction},
                                                    {"constant", setting::constant},
                                                    {"idle", setting::idle},
                                                    {"low-power", setting::idle},
                                                    {"protection", setting::protection}};
  return known;
}

template <class Value>
wish made(setting which, Value value) {
  return {which, requests::set(value), value};
}

wish frequency_wish(const std::string& word) {
  const double hz = number_of(word, min_scan_frequency_chz / 100.0, max_scan_frequency_chz / 100.0);
  const auto tenths = static_cast<std::uint16_t>(std::lround(hz * 10.0));
  if (std::abs(hz * 10.0 - tenths) > 1e-6) {
    throw bad_value(in_quotes(word) + " is no whole number of tenths, such as 7.5");
  }
  return made(setting::freq, scan_frequency{static_cast<std::uint16_t>(tenths * 10)});
}

wish wish_of(setting which, const std::string& value) {
  switch (which) {
    case setting::rate:
      using enum ranging_frequency;
      return made(which, choice_of<ranging_frequency>(value, {{"4k", khz_4},
                                                              {"8k", khz_8},
                                                              {"9k", khz_9},
                                                              {"4000", khz_4},
                                                              {"8000", khz_8},
                                                              {"9000", khz_9}}));
    case setting::freq:
      return frequency_wish(value);
    case setting::direction:
      return made(which,
                  choice_of<motor_direction>(value, {{"cw", motor_direction::clockwise},
                                                     {"ccw", motor_direction::counter_clockwise}}));
    case setting::constant:
      return made(which, choice_of<constant_frequency>(value, {{"on", constant_frequency::on},
                                                               {"off", constant_frequency::off}}));
    case setting::idle:
      return made(which,
                  choice_of<low_power>(value, {{"on", low_power::on}, {"off", low_power::off}}));
    case setting::protection:
      break;
  }
  return made(which,
              choice_of<power_down_protection>(
                  value, {{"on", power_down_protection::on}, {"off", power_down_protection::off}}));
}

request question_of(setting which) noexcept {
  switch (which) {
    case setting::rate:
      return requests::get_ranging();
    case setting::freq:
      return requests::get_scan_frequency();
    case setting::direction:
      return requests::get_direction();
    default:
      return requests::get_low_power();
  }
}

}  // namespace

std::string_view name_of(setting which) noexcept {
  constexpr std::array<std::string_view, all_settings.size()> words{
      "rate", "freq", "direction", "constant", "idle", "protection"};
  return words[static_cast<std::size_t>(which)];
}

bool can_be_read(setting which) noexcept {
  return which != setting::constant && which != setting::protection;
}

bool is_wish(std::string_view word) noexcept {
  const std::size_t equals = word.find('=');
  return equals != std::string_view::npos && equals > 0 &&
         std::all_of(word.begin(), word.begin() + static_cast<std::ptrdiff_t>(equals), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-';
         });
}

wish wish_of(const std::string& word) {
  const std::size_t equals = word.find('=');
  const setting which = choice_of<setting>(word.substr(0, equals), names());
  try {
    return wish_of(which, word.substr(equals + 1));
  } catch (const bad_value& reason) {
    throw bad_value(fmt::format("{}: {}", name_of(which), reason.what()));
  }
}

std::optional<answer> read_setting(g4lidar::lidar& lidar, setting which) {
  if (!can_be_read(which)) return std::nullopt;
  const auto given = lidar.ask(question_of(which));
  if (given) return *given;
  if (given.error().is_fatal()) throw failure(given.error());
  tell_more(given.error().message() + "\n");
  return std::nullopt;
}

std::string text_of(const std::optional<answer>& value) {
  if (!value) return "unknown";
  const auto on_or_off = [](bool on) { return std::string(on ? "on" : "off"); };
  if (const auto* rate = std::get_if<ranging_frequency>(&*value)) {
    return fmt::format("{}k", samples_per_second(*rate) / 1000);
  }
  if (const auto* frequency = std::get_if<scan_frequency>(&*value)) {
    const bool is_even = frequency->chz % 10 == 0;
    return fmt::format("{:.{}f}", frequency->chz / 100.0, is_even ? 1 : 2);
  }
  if (const auto* turns = std::get_if<motor_direction>(&*value)) {
    return *turns == motor_direction::clockwise ? "cw" : "ccw";
  }
  if (const auto* constant = std::get_if<constant_frequency>(&*value)) {
    return on_or_off(*constant == constant_frequency::on);
  }
  if (const auto* idle = std::get_if<low_power>(&*value)) return on_or_off(*idle == low_power::on);
  if (const auto* fed = std::get_if<power_down_protection>(&*value)) {
    return on_or_off(*fed == power_down_protection::on);
  }
  return "unknown";
}

nlohmann::ordered_json json_of(const std::optional<answer>& value) {
  std::string text = text_of(value);
  if (!value || text == "unknown") return nullptr;
  if (const auto* rate = std::get_if<ranging_frequency>(&*value)) return samples_per_second(*rate);
  if (const auto* frequency = std::get_if<scan_frequency>(&*value)) return frequency->chz / 100.0;
  if (std::holds_alternative<motor_direction>(*value)) return text;
  return text == "on";
}

}  // namespace g4_dump
