// SPDX-License-Identifier: MIT
#include "g4lidar/options/option_table.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "core/number_text.hpp"
#include "driver/error_context.hpp"
#include "g4lidar/core/request.hpp"
#include "setting_rows.hpp"

namespace g4lidar {

std::span<const setting_info> all_settings() noexcept { return setting_rows; }

const setting_info* setting_of(const answer& value) noexcept {
  const auto* const at = std::ranges::find_if(setting_rows, [&](const setting_info& each) {
    return each.values.empty() ? std::holds_alternative<scan_frequency>(value)
                               : each.values.front().value.index() == value.index();
  });
  return at == setting_rows.end() ? nullptr : at;
}

std::optional<answer> value_of(const setting_info& setting, std::int32_t number) noexcept {
  const auto at = std::ranges::find(setting.values, number, &setting_value::number);
  if (at != setting.values.end()) return at->value;
  if (!setting.values.empty() || number < least_of_all_chz || number > most_of_all_chz) {
    return std::nullopt;
  }
  return scan_frequency{static_cast<std::uint16_t>(number)};
}

result<answer> value_in(const setting_info& setting, std::string_view text, const model* model) {
  const std::string given = in_quotes(text);
  // What the model does not have at all is refused by the lidar.
  const bool is_known = model != nullptr && has_request(*model, setting.change);
  const auto refused = [&](std::string why, bool is_of_model = true) {
    if (!setting.unit.empty()) why.append(" ").append(setting.unit);
    if (is_known && is_of_model) {
      why.append(" of ").append(article_of(*model)).append(" ").append(model->name);
    }
    return failure(task::configuring, problem::bad_option, std::string(setting.name) + ": " + why);
  };
  if (setting.type == setting_type::decimal) {
    const double least = is_known ? model->frequency.min_chz / 100.0 : setting.least / 100.0;
    const double most = is_known ? model->frequency.max_chz / 100.0 : setting.most / 100.0;
    const auto number = number_in(text, least, most);
    if (!number) return refused(not_in_range(text, least, most));
    const double steps = *number * 100.0 / setting.step;
    const auto made =
        value_of(setting, static_cast<std::int32_t>(std::lround(steps)) * setting.step);
    if (made && std::abs(steps - std::round(steps)) <= 1e-6) return *made;
    return refused(given + " is not a multiple of " + text_of_number(setting.step / 100.0), false);
  }
  std::vector<std::string_view> possible;
  for (const setting_value& each : setting.values) {
    if (is_known && !is_possible(change_to(each.value), *model)) continue;
    const bool is_number =
        setting.type == setting_type::whole && text == std::to_string(each.number);
    if (is_number || text == each.word) return each.value;
    possible.push_back(each.word);
  }
  return refused(given + " is not one of " + list_of(possible));
}

// NOLINTNEXTLINE(bugprone-exception-escape): a variant of numbers always has a value
const setting_value* find_value(const answer& value) noexcept {
  const setting_info* const of = setting_of(value);
  if (of == nullptr) return nullptr;
  const auto at = std::ranges::find(of->values, value, &setting_value::value);
  return at == of->values.end() ? nullptr : &*at;
}

std::optional<std::int32_t> number_of(const answer& value) noexcept {
  if (const auto* frequency = std::get_if<scan_frequency>(&value)) return frequency->chz;
  const setting_value* const found = find_value(value);
  return found == nullptr ? std::nullopt : std::optional(found->number);
}

// NOLINTNEXTLINE(bugprone-exception-escape): the same
request change_to(const answer& value) noexcept {
  return std::visit(
      [](const auto& wanted) -> request {
        if constexpr (requires { requests::set(wanted); }) {
          return requests::set(wanted);
        } else {
          return {request_kind::set_scan_frequency, std::numeric_limits<std::uint16_t>::max()};
        }
      },
      value);
}

std::string speed_without_commands(const model& model) {
  return std::string(std::string_view(error_context("").add_speed(model, "")));
}

std::string ways_to_set(const model& model) {
  const std::string all(std::string_view(error_context("").add_ways(model)));
  return all.substr(2, all.size() - 3);  // " (...)"
}

void set_option(lidar_options& options, const answer& value) noexcept {
  const auto take = [&value]<class Setting>(std::optional<Setting>& option) {
    if (const auto* given = std::get_if<Setting>(&value)) option = *given;
  };
  take(options.sample_rate);
  take(options.frequency);
  take(options.direction);
  take(options.constant);
  take(options.idle);
  take(options.protection);
}

}  // namespace g4lidar
