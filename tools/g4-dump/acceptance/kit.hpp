// SPDX-License-Identifier: MIT
// The acceptance kit: what a real lidar does, step by step, compared with the table of models.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "g4lidar/discovery.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4_tool::acceptance {

using namespace g4lidar;

inline constexpr std::int64_t ms = 1'000'000;  // in ns

/// The steps of a run, in their order. The rows of rows.hpp state what each does.
enum class step : std::uint8_t {
  bridge,
  listening,
  identity,
  queries,
  protection,
  frequency,
  sample_rate,
  start_and_stop,
  dtr,
  stream,
  sample_bits,
  ct_information,
  time_packets,
  near_target,
  far_target,
  unplug,
};
inline constexpr std::size_t step_count = static_cast<std::size_t>(step::unplug) + 1;

/// How a step ended.
enum class finding : std::uint8_t {
  agrees,    ///< As expected by the table.
  observed,  ///< Not in the table; now it is known.
  not_done,  ///< Not possible with this lidar or connection, or the user declined.
  differs,   ///< Not as expected.
};

/// What one step has found.
struct step_result {
  step of;
  finding outcome = finding::agrees;
  std::vector<evidence> facts{};
  std::string text{};  ///< In sentences.

  /// Adds a sentence, and makes the outcome at least this one.
  void find(finding finding, std::string_view sentence);
  /// Adds a fact: a number, a text, or yes or no.
  void add(std::string name, auto value) {
    facts.push_back(make_evidence(std::move(name), std::move(value)));
  }
  void add(std::string name, bool is_so) {
    add(std::move(name), std::string(is_so ? "yes" : "no"));
  }
};

/// What the user is asked to do.
enum class user_action : std::uint8_t {
  place_near,  ///< To place a target straight ahead, 0.3 m to 1 m away, and to measure its distance.
  place_far,   ///< To place one 2 m to 5 m away in the same direction, and to measure its distance.
  unplug,      ///< To unplug the USB cable.
  plug_in,     ///< To plug it in again.
};

/// How a run is done. Functions that are not set are not called.
struct run_options {
  const g4lidar::model* model = &g4_model;  ///< What the lidar is compared with.
  std::uint32_t baud = 0;                   ///< 0: the usual one of the model, or what is found.
  const port_info* port = nullptr;          ///< That of the connection, if it is known.
  /// How long the scan of the steps `stream` to `time_packets` is observed.
  std::chrono::milliseconds stream_time = std::chrono::minutes(1);
  /// The longest wait for the user to unplug, and to plug in.
  std::chrono::milliseconds plug_time = std::chrono::minutes(2);
  /// The longest wait at the end for a lidar that was lost, to set its settings back.
  std::chrono::milliseconds return_time = std::chrono::seconds(10);
  /// Asks the user. Returns the distance that was measured, in millimetres, of a target; any number
  /// for the other actions; nothing if the user declines, which skips the step. Not set: all decline.
  std::function<std::optional<double>(user_action)> ask{};
  std::function<void(step)> on_step{};                  ///< Called when a step begins.
  std::function<void(const step_result&)> on_result{};  ///< With the result of each step.
  /// Called at the end if settings could not be set back, with the words of `g4-dump set`: "frequency=10".
  std::function<void(const std::string&)> on_lost_settings{};
  /// Called about 20 times a second; true ends the run. The settings are set back and the lidar is stopped then, too.
  std::function<bool()> is_cancelled{};
};

/// What a run has found.
struct report {
  std::vector<step_result> steps{};
  std::optional<error> failure{};  ///< What ended the connection before the last step.
};

/// Does all steps with the lidar behind `connector`. Sends every query and command that changes a setting; what a model
/// does not have is skipped. Whatever ends the run, also an exception of a function of `options`: the settings
/// are set back to what they were, and the motor is stopped. When the connection breaks for another reason than the
/// unplug, the remaining steps are not done.
[[nodiscard]] report run(connector& connector, const run_options& options);

/// "start_and_stop". The names do not change.
[[nodiscard]] std::string_view name_of(step step) noexcept;
/// "agrees", "observed", "not_done", "differs".
[[nodiscard]] std::string_view name_of(finding finding) noexcept;

}  // namespace g4_tool::acceptance
