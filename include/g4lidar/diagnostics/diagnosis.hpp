// SPDX-License-Identifier: MIT
// What a diagnostic run reports: stages, verdicts, evidence, and each diagnosis with cause and advice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "g4lidar/core/stream_counts.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"

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

}  // namespace g4lidar
