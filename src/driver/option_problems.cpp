// SPDX-License-Identifier: MIT
#include "option_problems.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <string_view>

#include "error_context.hpp"
#include "g4lidar/core/session/model_requests.hpp"
#include "g4lidar/setting_table.hpp"
#include "g4lidar/source.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using std::chrono::milliseconds;

error bad(std::string_view what) noexcept { return {task::configuring, problem::bad_option, what}; }

/// "OPTION: LEAST to MOST, not GIVEN UNIT".
error bad(std::string_view what, std::int64_t given, std::string_view unit) noexcept {
  error_context words(what);
  words.add(given < 0 ? ", not -" : ", not ");
  constexpr std::int64_t most = UINT32_MAX;
  const std::int64_t size = std::clamp(given, -most, most);
  return bad(words.add(static_cast<std::uint32_t>(size < 0 ? -size : size)).add(unit));
}

/// "sample_rate: 8000, 16000 or 18000 of a G6"; "frequency: 500 to 1200 (5 to 12 Hz of a G4), not 1300"; "idle: off or
/// on".
error bad_setting(const setting_info& of, const model& which, std::uint16_t given) noexcept {
  error_context words(of.name);
  words.add(": ");
  if (of.type == setting_type::whole) return bad(words.add_rates(which).add_owner(which));
  if (of.type != setting_type::decimal)
    return bad(words.add(of.values[0].word).add(" or ").add(of.values[1].word));
  const auto [least_dhz, most_dhz, reply, ct, pin] = which.frequency;
  words.add(least_dhz * 10U).add(" to ").add(most_dhz * 10U).add(" (").add(least_dhz / 10U);
  words.add(" to ").add(most_dhz / 10U).add(" Hz").add_owner(which).add(")");
  return bad(words, given, "");
}

/// What can use an option; whether two values of it differ, and how it is copied.
struct option_row {
  std::string_view name;
  option_users users;
  bool (*differs)(const lidar_options& a, const lidar_options& b);
  void (*copy)(lidar_options& to, const lidar_options& from);
};

/// `part(options)` is the member.
template <class Part>
constexpr option_row row(std::string_view name, option_users users, Part /*part*/) {
  return {name, users,
          [](const lidar_options& a, const lidar_options& b) { return !(Part{}(a) == Part{}(b)); },
          [](lidar_options& to, const lidar_options& from) { Part{}(to) = Part{}(from); }};
}

constexpr option_users any_file = recording | raw_file;

/// The options that not every source can use.
constexpr std::array option_rows{
    row("baud", live, [](auto& of) -> auto& { return of.baud; }),
    row("listen_only", live, [](auto& of) -> auto& { return of.listen_only; }),
    row("leave_dtr", live, [](auto& of) -> auto& { return of.leave_dtr; }),
    row("probe_all_ports", port, [](auto& of) -> auto& { return of.probe_all_ports; }),
    row("sample_rate", live, [](auto& of) -> auto& { return of.sample_rate; }),
    row("frequency", live, [](auto& of) -> auto& { return of.frequency; }),
    row("direction", live, [](auto& of) -> auto& { return of.direction; }),
    row("constant", live, [](auto& of) -> auto& { return of.constant; }),
    row("idle", live, [](auto& of) -> auto& { return of.idle; }),
    row("protection", live, [](auto& of) -> auto& { return of.protection; }),
    row("reconnect", live, [](auto& of) -> auto& { return of.reconnect; }),
    row("longest_backoff", live, [](auto& of) -> auto& { return of.tuning.longest_backoff; }),
    row("answer_time", live, [](auto& of) -> auto& { return of.tuning.answer_time; }),
    row("stall_time", live, [](auto& of) -> auto& { return of.tuning.stall_time; }),
    row("pace", live, [](auto& of) -> auto& { return of.tuning.pace; }),
    row("speed", any_file, [](auto& of) -> auto& { return of.playback.speed; }),
    row("loop", any_file, [](auto& of) -> auto& { return of.playback.loop; }),
    row("range", any_file, [](auto& of) -> auto& { return of.playback.from_ns; }),
    row("range", any_file, [](auto& of) -> auto& { return of.playback.to_ns; }),
    row("raw_sample_rate_hz", raw_file | counted_pipe,
        [](auto& of) -> auto& { return of.raw_sample_rate_hz; }),
    row("counts_times", raw_file | pipe, [](auto& of) -> auto& { return of.counts_times; }),
};

option_users with_counted(option_users users, const lidar_options& options) noexcept {
  const bool counts = (users & pipe) != 0 && options.counts_times;
  return counts ? static_cast<option_users>(users | counted_pipe) : users;
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
    case pipe | counted_pipe:
      return "a pipe";
    default:
      return "a file";
  }
}

}  // namespace

std::optional<error> problem_with_users(const lidar_options& options, option_users users) noexcept {
  const lidar_options usual;
  users = with_counted(users, options);
  for (const option_row& each : option_rows) {
    if ((each.users & users) != 0 || !each.differs(options, usual)) continue;
    error_context about(each.name);
    about.add(", and ").add(options.device.empty() ? "the source" : options.device);
    about.add(" is ").add(words_for(users));
    return error(task::configuring, problem::bad_option, about, 0, error_detail::other_source);
  }
  return std::nullopt;
}

lidar_options without_others(lidar_options options, option_users users) {
  const lidar_options usual;
  users = with_counted(users, options);
  for (const option_row& each : option_rows) {
    if ((each.users & users) == 0) each.copy(options, usual);
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
  const auto within = [](auto value, auto least, auto most) {
    return value >= least && value <= most;
  };
  if (options.tuning.pace > read_pace::revolutions)
    return bad("pace: automatic, packets or revolutions");
  const auto bad_time = [](std::string_view what, milliseconds given) {
    return bad(what, given.count(), " ms");
  };
  if (!within(options.tuning.longest_backoff, 1ms, 1000ms))
    return bad_time("longest_backoff: 1 ms to 1 s", options.tuning.longest_backoff);
  if (!within(options.tuning.answer_time, 10ms, 10'000ms))
    return bad_time("answer_time: 10 ms to 10 s", options.tuning.answer_time);
  if (!within(options.tuning.stall_time, 100ms, 60'000ms))
    return bad_time("stall_time: 100 ms to 1 min", options.tuning.stall_time);
  if (!within(options.tuning.batch, 0ms, 100ms))
    return bad_time("batch: 0 to 100 ms", options.tuning.batch);
  if (!within(options.tuning.transport_delay, 0ns, 1'000'000'000ns)) {
    return bad("transport_delay: 0 to 1 s", options.tuning.transport_delay.count(), " ns");
  }
  if (options.raw_sample_rate_hz && !within(*options.raw_sample_rate_hz, 1U, 1'000'000U)) {
    return bad("raw_sample_rate_hz: 1 to 1000000", *options.raw_sample_rate_hz, "");
  }
  return std::nullopt;
}

std::optional<error> problem_with(const lidar_options& options) noexcept {
  if (auto wrong = problem_with_settings(options)) return wrong;
  return problem_with_use(options);
}

}  // namespace g4lidar
