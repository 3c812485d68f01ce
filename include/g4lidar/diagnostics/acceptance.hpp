// SPDX-License-Identifier: MIT
// The acceptance run: what a real lidar does, step by step, compared with the table of models.
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
#include "g4lidar/detail/api.hpp"
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "g4lidar/discovery.hpp"
#include "g4lidar/transport/connector.hpp"

namespace g4lidar {

/// The steps of an acceptance run, in their order.
enum class acceptance_step : std::uint8_t {
  bridge,          ///< The USB bridge, and the baud rate that the system set.
  listening,       ///< What arrives before anything is sent.
  identity,        ///< The answer to 90.
  queries,         ///< Each query: its answer and its time.
  protection,      ///< Power-down protection, D9: switched and switched back.
  frequency,       ///< The limits of the scan frequency; then it is as before.
  sample_rate,     ///< The sample rate behind each code; then it is as before.
  start_and_stop,  ///< The times of spin-up and stop, and whether 00 alone stops.
  dtr,             ///< What the line DTR does.
  stream,          ///< Packets, rates and damage of a scan.
  sample_bits,     ///< The two lower bits of the samples.
  ct_information,  ///< The CT bytes of the revolutions, and the CRC byte behind them.
  time_packets,    ///< Whether there are any.
  near_target,     ///< The range and the direction of a target that the user places.
  far_target,      ///< The range of a farther one in the same direction.
  unplug,          ///< The lidar is unplugged and plugged in again by the user.
};
/// The number of steps.
inline constexpr std::size_t acceptance_step_count =
    static_cast<std::size_t>(acceptance_step::unplug) + 1;

/// How a step ended.
enum class acceptance_verdict : std::uint8_t {
  agrees,    ///< As in the table.
  observed,  ///< Not in the table; now it is known.
  not_done,  ///< Not possible with this lidar or connection, or the user declined.
  differs,   ///< Not as in the table.
};

/// The open questions about the family, in the order of open_questions().
enum class acceptance_question : std::uint8_t {
  bridge_and_baud,
  unasked_bytes,
  number,
  one_way_answers,
  optional_queries,
  zero_offset,
  health_codes,
  protection,
  frequency_limits,
  rate_codes,
  packet_lengths,
  forced_stop,
  spin_up,
  dtr_start,
  dtr_cut,
  reported_frequency,
  layout,
  lower_bits,
  flag_meaning,
  ct_bytes,
  time_packets,
  zero_direction,
  range_unit,
  kept_settings,
};
/// The number of open questions.
inline constexpr std::size_t acceptance_question_count =
    static_cast<std::size_t>(acceptance_question::kept_settings) + 1;

/// What a run shows about an open question, the best last.
enum class answer_state : std::uint8_t {
  not_decided,     ///< The measurements fit several answers, or there are none.
  not_applicable,  ///< The question does not arise with this model.
  answered,        ///< The measurements fit one answer.
};

/// An open question, as a run answers it.
struct question_answer {
  acceptance_question question = acceptance_question::bridge_and_baud;
  answer_state state = answer_state::not_decided;
  std::string text{};  ///< The answer, or the reason why there is none, in sentences.
};

/// The result of one step.
struct acceptance_result {
  acceptance_step step = acceptance_step::bridge;
  acceptance_verdict outcome = acceptance_verdict::agrees;
  std::vector<evidence> measurements{};
  std::string text{};  ///< What was found, in sentences.
  /// What the step shows about questions; several steps may show something about one. See answers_of().
  std::vector<question_answer> answers{};

  /// Adds a sentence, and makes the outcome at least this one.
  G4LIDAR_API void add_finding(acceptance_verdict how, std::string_view sentence);
  /// Adds evidence.
  void add(std::string name, auto value) {
    measurements.push_back(make_evidence(std::move(name), std::move(value)));
  }
  /// Adds what the step shows about a question.
  void add_answer(acceptance_question about, answer_state state, std::string_view sentence) {
    answers.push_back({about, state, std::string(sentence)});
  }
};

/// What the user is asked to do.
enum class acceptance_action : std::uint8_t {
  /// To place a target straight ahead, 0.3 m to 1 m away, and to measure its distance.
  place_near,
  place_far,  ///< To place one 2 m to 5 m away in the same direction, and to measure its distance.
  unplug,     ///< To unplug the USB cable.
  plug_in,    ///< To plug it in again.
};

/// A question about the family that only a real device answers, and the step that answers it.
struct open_question {
  std::string_view text;
  acceptance_step step;
  acceptance_question which;
};

/// How an acceptance run is done. Functions that are not set are not called.
struct acceptance_options {
  /// What the lidar is compared with. Null: the model that search() finds; if its bytes fit several models,
  /// no step is done, and the results list them. Valid as long as the run.
  const g4lidar::model* model = nullptr;
  std::uint32_t baud = 0;           ///< 0: as found, or the usual one of the model.
  const port_info* port = nullptr;  ///< That of the connection, if it is known.
  /// How long the scan of the steps `stream` to `time_packets` is observed.
  std::chrono::milliseconds stream_time = std::chrono::minutes(1);
  /// The longest wait for the user to unplug, and to plug in.
  std::chrono::milliseconds plug_time = std::chrono::minutes(2);
  /// Asks the user. Returns the distance that was measured, in millimetres, of a target; any number
  /// for the other actions; nothing if the user declines, which skips the step. Not set: all decline.
  std::function<std::optional<double>(acceptance_action)> ask{};
  /// Called when a step begins.
  std::function<void(acceptance_step)> on_step{};
  /// Called with the result of each step.
  std::function<void(const acceptance_result&)> on_result{};
  /// Called about 20 times a second; true ends the run. The lidar is stopped then, too.
  std::function<bool()> is_cancelled{};
};

/// Does all steps with the lidar behind `from`, and returns their results. Sends every query and
/// command that changes a setting, which is set back; what a model does not have is skipped. Stops the
/// motor at the end. Takes about 20 minutes with a real device, most of it for its user. Without a
/// connection, or when it breaks for another reason than the unplug, the remaining steps are skipped.
/// *Allocates. Single thread.*
[[nodiscard]] G4LIDAR_API std::vector<acceptance_result> run_acceptance(
    connector& from, const acceptance_options& options);

/// The open questions. Valid forever.
[[nodiscard]] G4LIDAR_API std::span<const open_question> open_questions() noexcept;
/// What these results show about each open question, in the order of open_questions(): where several steps
/// show something, the best state, and of these the last. A question about which no step shows anything is not
/// decided, and its text is the reason.
[[nodiscard]] G4LIDAR_API std::vector<question_answer> answers_of(
    std::span<const acceptance_result> results);
/// "start_and_stop". The names do not change.
[[nodiscard]] G4LIDAR_API std::string_view name_of(acceptance_step step) noexcept;
/// "agrees", "observed", "not_done", "differs".
[[nodiscard]] G4LIDAR_API std::string_view name_of(acceptance_verdict how) noexcept;
/// "not_decided", "not_applicable", "answered".
[[nodiscard]] G4LIDAR_API std::string_view name_of(answer_state state) noexcept;

}  // namespace g4lidar
