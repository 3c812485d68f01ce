// SPDX-License-Identifier: MIT
// The error of a request that was not answered.
#pragma once

#include <span>
#include <string_view>
#include <variant>

#include "error_context.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/error.hpp"
#include "live_stage.hpp"

namespace g4lidar {

/// What was being done in this stage.
[[nodiscard]] inline task task_of(const request& asked, live_stage stage) noexcept {
  if (asked.what == request_kind::start) return task::starting;
  if (asked.what == request_kind::stop) return task::stopping;
  if (stage == live_stage::identifying) return task::opening;
  if (stage != live_stage::preparing) return task::asking;
  return asked.what == request_kind::health ? task::starting : task::configuring;
}

/// `device` is the name of the transport.
[[nodiscard]] inline error error_of(const outcome& done, live_stage stage,
                                    std::string_view device) noexcept {
  const task doing = task_of(done.asked, stage);
  error_context about(device);
  if (stage != live_stage::identifying) about.add(done.asked);
  if (done.how == verdict::not_reached) {
    if (const auto* reached = std::get_if<scan_frequency>(&done.value)) {
      about.add(" (reached ").add(*reached).add(")");
    }
    return {doing, problem::not_reached, about};
  }
  if (done.how == verdict::still_scanning) return {doing, problem::does_not_stop, about};
  const bool is_setting_up = stage == live_stage::identifying || stage == live_stage::preparing;
  if (done.heard_nothing() && is_setting_up) return {doing, problem::silence, about};
  if (done.heard_noise_only()) return {doing, problem::garbage, about};
  return {doing, done.wrong_answers > 0 ? problem::wrong_answer : problem::timeout, about};
}

/// Of a request that a session refuses.
[[nodiscard]] inline error refusal_error(task doing, refusal why, const request& wanted,
                                         const model& which, std::string_view device) noexcept {
  error_context about = error_context(device).add(wanted);
  if (why == refusal::not_supported) {
    return {doing, problem::not_supported, about.add(", ").add(which.name)};
  }
  return {doing, why == refusal::bad_setting ? problem::bad_setting : problem::scanning, about};
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

/// Of a device that reports a model other than `which`.
[[nodiscard]] inline error other_device_error(const device_information& who, const model& which,
                                              std::string_view device) noexcept {
  error_context about = error_context(device).add(", model ").add(std::uint32_t{who.model});
  if (const model* const found = model_with_id(who.model, which.link)) {
    about.add(" (").add(found->name).add(")");
  }
  return {task::opening, problem::other_device, about.add(", not ").add(which.name)};
}

/// Whether a device of the model may report this number.
[[nodiscard]] constexpr bool may_be(const model& which, const device_information& who) noexcept {
  return who.model == which.ids[0] || who.model == which.ids[1];
}

}  // namespace g4lidar
