// SPDX-License-Identifier: MIT
#include "option_problems.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "error_context.hpp"
#include "g4lidar/core/request.hpp"
#include "g4lidar/options/option_table.hpp"
#include "g4lidar/transport/source.hpp"
#include "options/option_access.hpp"

namespace g4lidar {
namespace {

using namespace option_user;

error bad(std::string_view what) noexcept { return {task::configuring, problem::bad_option, what}; }

/// A limit in the largest unit in which it is whole: "1 min", "10 ms"; "0"; a number without a unit.
void add_limit(error_context& words, std::int64_t value, std::string_view unit) noexcept {
  struct larger {
    std::string_view from;
    std::int64_t count;
    std::string_view to;
  };
  constexpr std::array<larger, 3> units{
      {{"ns", 1'000'000'000, "s"}, {"ms", 1000, "s"}, {"s", 60, "min"}}};
  for (const auto& [from, count, to] : units) {
    if (unit != from || value == 0 || value % count != 0) continue;
    value /= count;
    unit = to;
  }
  words.add(static_cast<std::uint32_t>(value));
  if (value != 0 && !unit.empty()) words.add(" ").add(unit);
}

/// "OPTION: LEAST to MOST, not GIVEN UNIT".
error bad(std::string_view what, std::int64_t given, std::string_view unit) noexcept {
  error_context words(what);
  words.add(given < 0 ? ", not -" : ", not ");
  constexpr std::int64_t most = UINT32_MAX;
  const std::int64_t size = std::clamp(given, -most, most);
  words.add(static_cast<std::uint32_t>(size < 0 ? -size : size));
  return bad(words.add(unit.empty() ? "" : " ").add(unit));
}

/// "sample_rate: 8000, 16000 or 18000 of a G6"; "frequency: 500 to 1200 (5 to 12 Hz of a G4), not 1300"; "idle: off or
/// on".
error bad_setting(const setting_info& setting, const model& model, std::uint16_t given) noexcept {
  error_context words(setting.name);
  words.add(": ");
  if (setting.type == setting_type::whole) return bad(words.add_rates(model).add_owner(model));
  if (setting.type != setting_type::decimal)
    return bad(words.add(setting.values[0].word).add(" or ").add(setting.values[1].word));
  const auto [least_chz, most_chz, reply, ct, pin] = model.frequency;
  words.add(least_chz).add(" to ").add(most_chz).add(" (").add(least_chz / 100U);
  words.add(" to ").add(most_chz / 100U).add(" Hz").add_owner(model).add(")");
  return bad(words, given, "");
}

std::string_view words_for(option_users users) noexcept {
  switch (users) {
    case live:
    case live | port:
      return "a live lidar";
    case recording:
      return "a recording";
    case raw_file:
      return "a file of raw bytes";
    case pipe:
      return "a pipe";
    default:
      return "a file";
  }
}

}  // namespace

std::optional<error> problem_with_users(const lidar_options& options, option_users users) noexcept {
  const lidar_options usual;
  for (const parameter& each : all_parameters()) {
    if (each.access == nullptr || (each.users & users) != 0) continue;
    if (!each.access->differs(options, usual)) continue;
    error_context about(each.name);
    about.add(", and ").add(options.device.empty() ? "the source" : options.device);
    about.add(" is ").add(words_for(users));
    return error(task::configuring, problem::bad_option, about, 0, error_detail::other_source);
  }
  return std::nullopt;
}

lidar_options without_others(lidar_options options, option_users users) {
  const lidar_options usual;
  for (const parameter& each : all_parameters()) {
    if (each.access != nullptr && (each.users & users) == 0) each.access->copy(options, usual);
  }
  return options;
}

std::optional<error> problem_with_model(const lidar_options& options, const recognition& stated,
                                        std::string_view whose) {
  const model* const given = options.model;
  if (given == nullptr || stated.model == nullptr || *given == *stated.model) return std::nullopt;
  if (stated.by == known_by::nothing) return std::nullopt;
  const std::size_t size = sample_size(stated.model->samples.layout);
  const std::size_t given_size = sample_size(given->samples.layout);
  const bool is_simulated = kind_of_source(options.device) == source_kind::simulated;
  const bool insists = options.insist_on_model && !is_simulated;
  const bool is_sure = stated.by != known_by::samples && !insists;
  if (size == given_size && !is_sure) return std::nullopt;
  std::string subject = "model: ";
  subject.append(given->word).append(", and ").append(whose).append(" states ");
  subject += stated.model->word;
  if (size != given_size) {
    subject.append(", samples of ").append(std::to_string(size));
    subject.append(" bytes, not of ").append(std::to_string(given_size));
  } else if (stated.by == known_by::recording && !is_simulated) {
    subject.append(" (")
        .append(given->word)
        .append("!, or insist_on_model, reads it all the same)");
  }
  // Of a file, as of its lidar.
  const bool is_of_file = stated.by == known_by::recording || stated.by == known_by::samples;
  if (size != given_size && is_of_file && !is_simulated) {
    return error(task::opening, problem::other_device, subject, 0, error_detail::other_samples);
  }
  return error(task::opening, problem::bad_option, subject);
}

std::optional<error> problem_with_settings(const lidar_options& options) noexcept {
  const model& which = options.model != nullptr ? *options.model : g4_model;
  std::optional<error> found;
  const auto check = [&](const auto& setting) {
    if (found || !setting) return;
    const setting_info& of = *setting_of(*setting);
    const request change = requests::set(*setting);
    if (options.listen_only) {
      found.emplace(task::configuring, problem::not_supported,
                    error_context(of.name).add(", ").add(which.name), 0,
                    error_detail::only_listens);
    } else if (!has_request(which, change.what)) {
      found.emplace(task::configuring, problem::not_supported,
                    error_context(of.name).add(", ").add(which.name).add_ways(which));
    } else if (!is_possible(change, which)) {
      found = bad_setting(of, which, change.value);
    }
  };
  check(options.sample_rate);
  check(options.frequency);
  check(options.direction);
  check(options.constant);
  check(options.idle);
  check(options.protection);
  // Of a file whose model is not known yet, it is checked when that is known.
  if (found || !options.zero_angle || options.model == nullptr) return found;
  if (!has_request(which, request_kind::zero_angle)) {
    found.emplace(task::configuring, problem::not_supported,
                  error_context("zero_angle, ").add(which.name));
  } else if (options.zero_angle->cdeg < -36'000 || options.zero_angle->cdeg > 36'000) {
    found = bad("zero_angle: -360 to 360 degrees");
  }
  return found;
}

std::optional<error> problem_with_use(const lidar_options& options) noexcept {
  for (const parameter& each : all_parameters()) {
    if (each.access == nullptr || each.access->number == nullptr) continue;
    const std::int64_t given = each.access->number(options);
    const auto least = static_cast<std::int64_t>(each.range[0]);
    const auto most = static_cast<std::int64_t>(each.range[1]);
    if (least <= given && given <= most) continue;
    error_context words(each.name);
    words.add(": ");
    if (!each.words.empty())
      return bad(
          words.add(each.words[0]).add(", ").add(each.words[1]).add(" or ").add(each.words[2]));
    add_limit(words, least, each.unit);
    words.add(" to ");
    add_limit(words, most, each.unit);
    return bad(words, given, each.unit);
  }
  return std::nullopt;
}

std::optional<error> problem_with(const lidar_options& options) noexcept {
  if (auto wrong = problem_with_settings(options)) return wrong;
  return problem_with_use(options);
}

}  // namespace g4lidar
