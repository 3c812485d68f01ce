// SPDX-License-Identifier: MIT
#include "kept_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "g4lidar/core/model_record.hpp"

namespace g4_tool::acceptance {
namespace {

using enum command;
using known_value = kept_settings::value;

constexpr std::int32_t protection_off = 1;

// Each step may be lost, or only its answer: what counts is what a query answers.
bool set_frequency(lidar_link& link, std::int32_t wanted_chz) {
  constexpr int near_chz = 5;  // half of the smallest step
  constexpr int most_steps = 60;
  constexpr int most_without_effect = 5;
  known_value last;
  int without_effect = 0;
  for (int i = 0; i < most_steps && without_effect < most_without_effect; ++i) {
    const known_value now = link.number(frequency_query);
    if (!now) return false;
    const int missing = wanted_chz - *now;
    if (std::abs(missing) <= near_chz) return true;
    without_effect = now == last ? without_effect + 1 : 0;
    last = now;
    const bool is_coarse = std::abs(missing) >= 100;
    const command up = is_coarse ? frequency_up_1_hz : frequency_up_0_1_hz;
    const command down = is_coarse ? frequency_down_1_hz : frequency_down_0_1_hz;
    static_cast<void>(link.ask(missing > 0 ? up : down));
  }
  return false;
}

bool set_rate(lidar_link& link, std::int32_t wanted_code) {
  constexpr int most_steps = 12;
  bool has_query = true;  // some firmware answers only the step
  for (int i = 0; i < most_steps; ++i) {
    const known_value now = has_query ? link.number(sample_rate_query) : std::nullopt;
    has_query = now.has_value();
    if (now == wanted_code || link.ask(sample_rate_next).number() == wanted_code) return true;
  }
  return false;
}

bool set_protection(lidar_link& link, std::int32_t wanted) {
  constexpr int most_switches = 6;
  for (int i = 0; i < most_switches; ++i) {
    if (link.ask(protection_toggle).number() == wanted) return true;
  }
  return false;
}

}  // namespace

void kept_settings::remember(lidar_link& link, const model& model) {
  if (is_remembered_ || !link.is_two_way()) return;
  is_remembered_ = true;
  link.stop();
  if (model.frequency.max_chz != 0) at(setting::frequency).before = link.number(frequency_query);
  if (model.rates.is_settable) at(setting::sample_rate).before = link.number(sample_rate_query);
}

void kept_settings::learn_from(setting setting, std::int32_t first_answer, std::int32_t values) {
  if (!at(setting).before) at(setting).before = (first_answer + values - 1) % values;
}

void kept_settings::has_none(setting setting) {
  at(setting).is_changed = at(setting).before.has_value();
}

bool kept_settings::is_changed() const { return std::ranges::any_of(all_, &kept::is_changed); }

bool kept_settings::restore(lidar_link& link) {
  constexpr int tries = 3;
  const auto set_back = [&](setting setting, auto set, const known_value& wanted) {
    kept& its = at(setting);
    if (its.is_changed && wanted) its.is_changed = !set(link, *wanted);
  };
  for (int i = 0; i < tries && is_changed() && !link.is_over(); ++i) {
    if (!link.stop()) continue;
    set_back(setting::frequency, set_frequency, before(setting::frequency));
    set_back(setting::sample_rate, set_rate, before(setting::sample_rate));
    set_back(setting::protection, set_protection,
             before(setting::protection).value_or(protection_off));
  }
  return !is_changed();
}

std::string kept_settings::words(const model& model) const {
  std::string all;
  const auto add = [&](setting setting, const std::string& word) {
    if (at(setting).is_changed) all += (all.empty() ? "" : " ") + word;
  };
  const std::int32_t chz =
      before(setting::frequency).value_or(0) + model.frequency.reply_offset_chz;
  const std::int32_t code = before(setting::sample_rate).value_or(all_rate_codes);
  const std::uint32_t hz = rate_hz_of_code(model, static_cast<std::uint8_t>(code));
  add(setting::frequency, fmt::format("frequency={:g}", chz / 100.0));
  add(setting::sample_rate, fmt::format("sample_rate={}", hz != 0 ? hz : first_rate_hz(model)));
  add(setting::protection,
      fmt::format("protection={}", before(setting::protection) == 0 ? "on" : "off"));
  return all;
}

}  // namespace g4_tool::acceptance
