// SPDX-License-Identifier: MIT
// The error of a request that was not answered.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <variant>

#include "driver/live/live_stage.hpp"
#include "error_context.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/options/option_table.hpp"
#include "link/connection.hpp"
#include "survey/unrecognised_bytes.hpp"

namespace g4lidar {

/// What was being done in this stage.
[[nodiscard]] inline task task_of(const request& asked, live_stage stage) noexcept {
  if (asked.what == request_kind::start) return task::starting;
  if (asked.what == request_kind::stop) return task::stopping;
  if (stage == live_stage::identifying) return task::opening;
  if (stage != live_stage::preparing) return task::asking;
  return asked.what == request_kind::health ? task::starting : task::configuring;
}

/// "/dev/ttyUSB0, S2 (115200 or 128000 baud) at 128000 baud": where the model has one rate, and it is read at that,
/// without the last one.
[[nodiscard]] inline error_context opened_as(const connection& connection,
                                             const model& model) noexcept {
  error_context about = error_context(connection.name()).add(", ").add(model.name);
  about.add(" (").add(model.bauds[0]);
  if (model.bauds[1] != 0) about.add(" or ").add(model.bauds[1]);
  about.add(" baud)");
  const std::uint32_t used = connection.is_open() ? connection.port().baud() : 0;
  if (used == 0 || (used == model.bauds[0] && model.bauds[1] == 0)) return about;
  return about.add(" at ").add(used).add(" baud");
}

/// `model` is the model as which the device was opened; `heard` what it sent since.
[[nodiscard]] inline error error_of(const outcome& done, live_stage stage,
                                    const connection& connection, const model& model,
                                    const unrecognised_bytes& heard) noexcept {
  const task doing = task_of(done.asked, stage);
  const bool is_known = stage != live_stage::identifying;
  const auto why = is_known ? error_detail::answered_before : error_detail::usual;
  error_context about =
      is_known ? error_context(connection.name()).add(done.asked) : opened_as(connection, model);
  if (done.how == verdict::not_reached) {
    if (const auto* reached = std::get_if<scan_frequency>(&done.value)) {
      about.add(" (reached ").add(*reached).add(")");
    }
    return {doing, problem::not_reached, about};
  }
  if (done.how == verdict::still_scanning) return {doing, problem::does_not_stop, about};
  const bool is_setting_up = !is_known || stage == live_stage::preparing;
  if (done.heard_nothing() && is_setting_up) return {doing, problem::silence, about, 0, why};
  if (done.heard_noise_only()) {
    return {doing, problem::garbage, about.add(heard.text()), 0, why};
  }
  return {doing, done.wrong_answers > 0 ? problem::wrong_answer : problem::timeout, about};
}

/// Of a scan whose bytes are no packets.
[[nodiscard]] inline error without_packets(const connection& connection,
                                           std::uint64_t count) noexcept {
  constexpr std::uint64_t most = 4'000'000'000;
  const error_context about = error_context(connection.name())
                                  .add(", ")
                                  .add(static_cast<std::uint32_t>(std::min(count, most)))
                                  .add(" bytes without a valid packet");
  return {task::reading, problem::garbage, about, 0, error_detail::answered_before};
}

/// Of a request that a session refuses.
[[nodiscard]] inline error refusal_error(task doing, refusal why, const request& wanted,
                                         const model& model, std::string_view device) noexcept {
  error_context about = error_context(device).add(wanted);
  if (why == refusal::not_supported) {
    about.add(", ").add(model.name);
    const bool is_setting = std::ranges::any_of(
        all_settings(), [&](const auto& of) { return of.change == wanted.what; });
    return {doing, problem::not_supported, is_setting ? about.add_ways(model) : about};
  }
  if (why != refusal::bad_setting) return {doing, problem::scanning, about};
  if (wanted.what == request_kind::set_scan_frequency) {
    about.add(" (").add_frequencies(model).add_owner(model).add(")");
  } else if (wanted.what == request_kind::set_sample_rate) {
    about.add(" (").add_rates(model).add_owner(model).add(")");
  }
  return {doing, problem::bad_setting, about};
}

/// `why`, which ends with the name of the model that was found, and the words of those between which the
/// bytes do not decide: "/dev/ttyUSB0, X2 (or x2l, x3)". One of them may be what the user has.
[[nodiscard]] inline error with_candidates(const error& why,
                                           std::span<const model* const> candidates) noexcept {
  if (candidates.size() < 2) return why;
  error_context about(why.subject());
  std::string_view before = " (or ";
  for (const model* const each : candidates.subspan(1)) {
    about.add(before).add(each->word);
    before = ", ";
  }
  return {why.doing(), why.code(), about.add(")"), why.system_errno(), why.detail()};
}

/// Of packets with samples of another size than the model has, which was stated.
[[nodiscard]] inline error other_samples_error(std::size_t sample_bytes, const model& model,
                                               std::string_view device) noexcept {
  const auto own = static_cast<std::uint32_t>(sample_size(model.samples.layout));
  const error_context about = error_context(device)
                                  .add(", packets with samples of ")
                                  .add(static_cast<std::uint32_t>(sample_bytes))
                                  .add(" bytes, and ")
                                  .add(article_of(model))
                                  .add(" ")
                                  .add(model.name)
                                  .add(" has ")
                                  .add(own);
  return {task::reading, problem::other_device, about, 0, error_detail::other_samples};
}

/// The error of a device that reports a model other than `lidar_model`; nothing if it may be `lidar_model`. The answer
/// of a two-way lidar is one of the numbers of its model. What a one-way lidar reports may be another one.
[[nodiscard]] inline std::optional<error> other_device_error(const device_information& information,
                                                             const model& lidar_model,
                                                             std::string_view device) noexcept {
  const bool answers = lidar_model.link == link_kind::two_way;
  const model* const found = answers ? model_with_id(information.model, lidar_model.link)
                                     : one_way_other_than(lidar_model, information.model);
  if (lidar_model.has_number(information.model) || (!answers && found == nullptr))
    return std::nullopt;
  error_context about = error_context(device).add(", model ").add(std::uint32_t{information.model});
  if (found != nullptr) about.add(" (").add(found->name).add(")");
  return error(task::opening, problem::other_device, about.add(", not ").add(lidar_model.name));
}

}  // namespace g4lidar
