// SPDX-License-Identifier: MIT
// The doctor: it examines a lidar, its connection, its port, or a file of its bytes. What it reports: stages, verdicts,
// evidence, and each diagnosis with cause and advice; as statuses of ROS 2, too.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "g4lidar/background_reader.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/stream_counts.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/filter.hpp"
#include "g4lidar/lidar_event.hpp"
#include "g4lidar/message/ros_messages.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar {

/// The stages of a diagnostic run, in the order in which they are reported.
enum class diagnostic_stage : std::uint8_t {
  port,
  permission,
  holder,
  baud_rate,
  answers,
  identity,
  health,
  motor,
  stream,
  rate,
  loss,
  returns,
  usb_latency,
};
/// The number of stages.
inline constexpr std::size_t diagnostic_stage_count =
    static_cast<std::size_t>(diagnostic_stage::usb_latency) + 1;

/// How a stage ended, the worst last.
enum class stage_verdict : std::uint8_t { ok, skipped, warn, fail };

/// Every possible diagnosis. describe() returns cause and advice of each.
enum class diagnosis : std::uint8_t {
  no_port,
  several_ports,
  not_serial,
  cannot_connect,
  system,
  bad_file,
  permission,
  busy,
  interference,
  bad_baud_rate,
  changed_bytes,
  no_lidar,
  unknown_bytes,
  wrong_baud_rate,
  silent,
  deaf,
  one_way_lidar,
  was_scanning,
  answers_late,
  answers_wrong,
  answers_twice,
  no_zero_angle,
  answers_missing,
  other_number,
  other_device,
  health_warning,
  health_error,
  brown_out,
  reboots,
  does_not_start,
  motor_stuck,
  no_motor_power,
  motor_unsteady,
  unplugged,
  stalls,
  scan_ends,
  protection_on,
  jolts,
  host_busy,
  frequency_off,
  sample_rate_off,
  bits_flipped,
  bytes_dropped,
  bytes_inserted,
  bursts,
  packets_truncated,
  packets_lost,
  line_noise,
  no_returns,
  usb_latency,
};
/// The number of diagnoses.
inline constexpr std::size_t diagnosis_count = static_cast<std::size_t>(diagnosis::usb_latency) + 1;

/// The description of a diagnosis. Valid forever.
struct diagnosis_info {
  std::string_view name;    ///< Equal to the enumerator. It does not change: for programs.
  stage_verdict severity;   ///< warn or fail.
  std::string_view cause;   ///< The most likely cause: sentences.
  std::string_view advice;  ///< What to try: sentences. The same as error::advice(), where the
                            ///< library has an error for it.
  std::span<const diagnosis>
      alternatives;  ///< Diagnoses that look the same to a host, the most likely first.
};

/// In general; stage_report::explain() knows the case. *Any thread.* (docs/design/doctor.md)
[[nodiscard]] G4LIDAR_API diagnosis_info describe(diagnosis what) noexcept;
/// "baud_rate", "answers". The names do not change.
[[nodiscard]] G4LIDAR_API std::string_view name_of(diagnostic_stage where) noexcept;
/// "ok", "skipped", "warn", "fail".
[[nodiscard]] G4LIDAR_API std::string_view name_of(stage_verdict how) noexcept;
/// The diagnosis for an error that ended a connection, or prevented it from being opened.
[[nodiscard]] G4LIDAR_API diagnosis diagnosis_of(problem what) noexcept;
/// The diagnosis for `size` raw bytes, such as a file, in which a stream_counter counted `counts`:
/// bad_file if there are none; unknown_bytes if they contain no packet and no response; line_noise
/// if they contain packets, but more than half of them belong to none. Nothing if there is no fault:
/// bytes with responses only are those of a lidar that was not scanning.
[[nodiscard]] G4LIDAR_API std::optional<diagnosis> diagnosis_of(const stream_counts& counts,
                                                                std::uint64_t size) noexcept;

/// One measurement or fact: a name that ends in its unit ("slowest_ms"), and a value.
struct evidence {
  std::string name;
  std::variant<std::int64_t, double, std::string> value;

  /// "ms", "s", "Hz", "%" or "baud"; empty for counts and texts. Valid forever.
  [[nodiscard]] G4LIDAR_API std::string_view unit() const noexcept;
  /// The value for people, without its unit: numbers with four digits or all before the point.
  [[nodiscard]] G4LIDAR_API std::string text() const;
};

/// A measurement from a value of any type: a whole number, a number, or else a text. Allocates.
template <class Value>
[[nodiscard]] evidence make_evidence(std::string name, Value value) {
  if constexpr (std::is_integral_v<Value>) {
    return {std::move(name), static_cast<std::int64_t>(value)};
  } else if constexpr (std::is_floating_point_v<Value>) {
    return {std::move(name), static_cast<double>(value)};
  } else {
    return {std::move(name), std::string(std::move(value))};
  }
}

/// On what way the bytes of a source come to this program.
enum class byte_path : std::uint8_t {
  line,     ///< A serial line at this computer; also of a simulated lidar.
  network,  ///< A network bridge: what is behind it is not known.
  file,     ///< A recording, or a file of raw bytes.
};

/// How one stage ended.
struct stage_report {
  diagnostic_stage stage = diagnostic_stage::port;
  stage_verdict outcome = stage_verdict::ok;
  std::vector<diagnosis> diagnoses{};  ///< The most likely first.
  std::vector<evidence> measurements{};
  std::string remark{};                       ///< One more sentence; empty: none.
  byte_path by = byte_path::line;             ///< On what way the bytes came.
  error_detail detail = error_detail::usual;  ///< Which case of its diagnosis it is.

  /// describe() for one of its diagnoses, with the cause and the advice for this way of the bytes and for this case: of
  /// what came through a network no cable is at fault. Valid forever.
  [[nodiscard]] G4LIDAR_API diagnosis_info explain(diagnosis what) const noexcept;

  /// Adds a diagnosis, once, and raises the verdict to its severity.
  G4LIDAR_API void find(diagnosis what);
  /// Adds evidence.
  template <class Value>
  void add(std::string name, Value value) {
    measurements.push_back(make_evidence(std::move(name), std::move(value)));
  }
};

/// The current activity of a diagnostic run.
enum class diagnostic_activity : std::uint8_t {
  listening,    ///< Bytes that arrive without a query.
  asking,       ///< All queries, several times.
  searching,    ///< All baud rates, for a lidar that was not found at the first one; up to 6 s.
  starting,     ///< The start command was sent.
  spinning_up,  ///< The lidar has accepted the start command and has sent no packet yet; up to 10 s.
  measuring,    ///< The running scan.
};

/// Options and callbacks of a diagnostic run. The callbacks may be empty.
struct diagnostic_options {
  std::uint32_t baud = 0;  ///< Bits per second; 0: those of the model, or as search() finds them.
  /// The model that is expected. Null: of a device the one that its replies or its bytes show, as
  /// search() finds it; of a file what a recording states, or the raw bytes show, as
  /// model_of_source() finds it. Valid forever.
  const g4lidar::model* model = nullptr;
  bool insist_on_model = false;  ///< As that of lidar_options: whatever number the lidar reports.
  /// As that of lidar_options: not a byte is sent. What needs answers is skipped, and a lidar that waits for a command
  /// is silent. Where the source has no name, there must be one port with the bridge of a G4.
  bool listen_only = false;
  bool probe_all_ports = false;  ///< As that of lidar_options, where the source has no name.
  /// How long to measure the running scan; a file is always read completely.
  std::chrono::nanoseconds measuring_time = std::chrono::seconds(5);
  /// The directions that the user wants: its field_of_view and ignored_sectors, in its frame, for the model that is
  /// found. Of what lies outside of them the stage returns reports nothing. The sectors must outlive the run.
  point_filter directions{};
  /// Called about 20 times a second; returning true ends the run. The lidar is stopped then, too.
  std::function<bool()> is_cancelled{};
  /// Called with each stage when it ends, also with stages that are skipped.
  std::function<void(const stage_report&)> on_stage{};
  /// Called when the run begins to wait for something.
  std::function<void(diagnostic_activity)> on_activity{};
};

/// Executes all stages and returns their reports, for the `source` of this name (transport/source.hpp). Stages that
/// need a device are skipped for a file.
///
/// Takes about 3 s plus `measuring_time` with a healthy lidar, 8 s if it has to be searched, and at most
/// 45 s plus `measuring_time` with one fault, if answers are at most 4 s late. Sends queries, starts,
/// and stops; as long as nothing has answered and no model is named, only the question for the device
/// information. To a model without commands none but two bytes while it is searched. Changes no setting;
/// the motor is stopped at the end, if it can be. *Allocates. Single thread.*
[[nodiscard]] G4LIDAR_API std::vector<stage_report> diagnose(
    std::string_view source, const diagnostic_options& options = {});

/// The same for an open transport: the stages from baud_rate on.
[[nodiscard]] G4LIDAR_API std::vector<stage_report> diagnose(
    std::unique_ptr<transport> opened, const diagnostic_options& options = {});

/// The same for the transports of `connector`. If it fails to connect, the first stages report that.
[[nodiscard]] G4LIDAR_API std::vector<stage_report> diagnose(
    connector& connector, const diagnostic_options& options = {});

/// The status of a stage: warn and fail become warn and error, skipped becomes ok with its remark. Its
/// evidence is in `values`, the name of each diagnosis too. Allocates.
[[nodiscard]] G4LIDAR_API diagnostic_status status_of(const stage_report& stage,
                                                      std::string_view hardware_id);
/// "g4lidar: state": what a reader does, with its device and as which model that is read. An error where there is no
/// lidar; a warning where something contradicts the model. `why`: reader_status::why in words; empty: not an error, as
/// the end of a file. Allocates.
[[nodiscard]] G4LIDAR_API diagnostic_status status_of(const reader_status& now,
                                                      std::string_view why);
/// "g4lidar: counts" with all counts, level ok. Allocates.
[[nodiscard]] G4LIDAR_API diagnostic_status status_of(const lidar_counts& counts,
                                                      std::string_view hardware_id);
/// The statuses of all stages, then the counts. Allocates.
[[nodiscard]] G4LIDAR_API std::vector<diagnostic_status> statuses_of(
    std::span<const stage_report> stages, const lidar_counts& counts, std::string_view hardware_id);

}  // namespace g4lidar
