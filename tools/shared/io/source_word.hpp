// SPDX-License-Identifier: MIT
// What the word SOURCE means, and the lidar behind it.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/common_options.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/recording/raw_bytes.hpp"
#include "g4lidar/recording/reader.hpp"
#include "g4lidar/sim/setup.hpp"
#include "g4lidar/transport/source.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4_tool {

/// The world and the path that a setup names, or the built-in rooms. Throws a failure.
[[nodiscard]] sim::world load_scene(const sim::setup& setup);

/// For lidar_options::wrap: puts something between the driver and each connection, such as a log.
using transport_tap = std::function<std::unique_ptr<transport>(std::unique_ptr<transport>)>;
[[nodiscard]] std::function<result<std::unique_ptr<connector>>(std::unique_ptr<connector>)>
for_each_connection(transport_tap tap);

/// Throws a failure if the user has given an option that the source cannot use. `wanted` has those of the verb.
void refuse_options_of_others(const common_options& options, const lidar_options& wanted = {});
/// Throws a bad_value if --zero-angle is given, which what is done with a file does not use, and why.
void refuse_zero_angle(const common_options& options, std::string_view why);
/// `wanted` with device, model, baud, reconnect and waiting of the options. Signals cancel. The model that raw
/// bytes show is logged when they are opened.
[[nodiscard]] lidar_options options_for(const common_options& options, lidar_options wanted);
/// What sends the bytes of the source: that of --model or of the name, or what a file shows. Raw bytes that
/// show it are reported by report_model(), or stored in `shown` and not reported. Null: not known before a pipe or
/// a device is opened; then it is opened_source::model(). Throws a failure, also for options that the source cannot use, and a bad_value if a recording is of another model than that of --model.
[[nodiscard]] const g4lidar::model* model_of(const common_options& options,
                                             std::optional<recognised_model>* shown = nullptr);
/// Logs what raw bytes were recognised as, in a line, unless it is a G4 for certain: which models also send
/// such bytes, if the bytes do not name theirs (`is_usual`).
void report_model(const g4lidar::model& found, bool is_usual);
void report_model(const recognised_model& found);
/// Logs that the angles lack the offset of zero of this model.
void report_missing_zero(const g4lidar::model& model);
/// Logs what contradicts the model, if anything does, and once.
void report_contradictions(const std::string& now);
void report_contradictions(const g4lidar::recognition& found);
/// The same, once the first packets have decided as which model a lidar is read whose number no model has.
void report_contradictions(const g4lidar::lidar& from);
/// Logs between which models the bytes of a device do not decide, if there are several.
void report_candidates(std::span<const g4lidar::model* const> candidates);
/// The error of a lidar that was opened so, in the words of the tool.
[[nodiscard]] failure failure_of(const common_options& options, const g4lidar::error& why);

/// Bytes of a beginning: enough to see how a terminal has changed them.
inline constexpr std::size_t beginning_bytes = std::size_t{128} << 10U;
inline constexpr const char* raw_bytes_advice =
    "Give a file of raw bytes from the lidar's port, or pipe them in.";
/// Of a file on disk; nothing of all else. - is standard input.
[[nodiscard]] std::optional<std::uint64_t> size_of_file(const std::string& path);
/// Its name in messages.
[[nodiscard]] std::string title_of_input(const std::string& source);

/// The lidar behind the word SOURCE, and what else is there.
class opened_source {
 public:
  /// `wanted`: all but device, model, baud, reconnect and waiting, which are those of the options. With
  /// loss_rule::wait it waits until there is a lidar or a signal comes (`interrupted`). Throws a failure.
  explicit opened_source(const common_options& options, lidar_options wanted = {});
  opened_source(const opened_source&) = delete;
  opened_source& operator=(const opened_source&) = delete;
  ~opened_source() = default;

  [[nodiscard]] g4lidar::lidar& lidar() noexcept {
    return *lidar_;  // NOLINT(bugprone-unchecked-optional-access): made by the constructor
  }

  /// The model as which the lidar is read.
  [[nodiscard]] const g4lidar::model& model() noexcept { return *lidar().recognition().model; }

  /// The simulated lidar that is read, with the robot that carries it; null for every other source.
  [[nodiscard]] const sim::simulated_source* simulation() const noexcept { return simulation_; }

  /// The reader of the recording that is played; null for every other source.
  [[nodiscard]] const g4lidar::recording_reader* recording() const noexcept { return played_; }
  /// The bytes of its file, and how many of them have been read; 0 of all else.
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  [[nodiscard]] std::uint64_t position() const noexcept {
    return played_ != nullptr
               ? played_->position()
               : lidar_->counts().bytes;  // NOLINT(bugprone-unchecked-optional-access): as lidar()
  }
  /// The first bytes of raw bytes: what is known of them where they are not packets.
  [[nodiscard]] std::span<const std::uint8_t> beginning() const noexcept { return beginning_; }
  /// What is wrong with the recording that is played, as far as it was read; nothing of all else.
  [[nodiscard]] g4lidar::recording_damage damage() const {
    return played_ == nullptr ? g4lidar::recording_damage{} : played_->damage();
  }

 private:
  const sim::simulated_source* simulation_ = nullptr;  // the lidar's
  const g4lidar::recording_reader* played_ = nullptr;  // the same
  std::uint64_t size_ = 0;
  std::vector<std::uint8_t> beginning_;  // outlives the lidar
  std::optional<g4lidar::lidar> lidar_;
};

}  // namespace g4_tool
