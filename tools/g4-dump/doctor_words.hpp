// SPDX-License-Identifier: MIT
// What the doctor can say: its stages, its verdicts, and every diagnosis with cause and advice.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "exit_code.hpp"

namespace g4_dump {

/// In the order in which they are gone through.
enum class stage : unsigned char {
  port,
  permission,
  holder,
  baud_rate,
  answer,
  identity,
  health,
  motor,
  stream,
  rate,
  loss,
  usb_latency,
};
inline constexpr std::size_t stage_count = static_cast<std::size_t>(stage::usb_latency) + 1;

enum class verdict : unsigned char { ok, skipped, warn, fail };

/// Everything that can be found. The names, which are the enumerators, do not change.
enum class diagnosis : unsigned char {
  no_port,
  several_ports,
  not_serial,
  cannot_connect,
  system,
  permission,
  busy,
  interference,
  bad_baud_rate,
  wrong_baud_rate,
  silent,
  deaf,
  was_scanning,
  answers_late,
  answers_wrong,
  answers_twice,
  answers_missing,
  other_device,
  health_warning,
  health_error,
  brown_out,
  reboots,
  does_not_start,
  motor_stuck,
  motor_unsteady,
  unplugged,
  stalls,
  scan_ends,
  protection_on,
  jolts,
  frequency_off,
  sample_rate_off,
  bits_flipped,
  bytes_dropped,
  bytes_inserted,
  bursts,
  packets_truncated,
  packets_lost,
  line_noise,
  usb_latency,
};
inline constexpr std::size_t diagnosis_count = static_cast<std::size_t>(diagnosis::usb_latency) + 1;

/// What is to be said of a diagnosis. All of it lives for ever.
struct diagnosis_words {
  diagnosis what;
  std::string_view name;
  verdict how;                         ///< warn or fail.
  exit_code code;                      ///< Of a failed stage.
  std::string_view cause;              ///< A sentence.
  std::string_view advice;             ///< What to try: sentences. Where docs/errors.md has the
                                       ///< problem, the library's.
  std::span<const diagnosis> or_else;  ///< What looks the same from here, the likelier first.
};

[[nodiscard]] const diagnosis_words& words_of(diagnosis what);
[[nodiscard]] std::string_view name_of(stage where) noexcept;
[[nodiscard]] std::string_view name_of(verdict how) noexcept;

/// Something measured: a name with its unit in it, and a value.
struct fact {
  std::string name;
  std::variant<std::int64_t, double, std::string> value;
};

/// How a stage went.
struct stage_report {
  stage where = stage::port;
  verdict how = verdict::ok;
  std::vector<diagnosis> found{};  ///< The likeliest first.
  std::vector<fact> facts{};
  std::string remark{};  ///< A sentence more; empty: none.

  /// Adds a diagnosis once, and lets the verdict follow it.
  void find(diagnosis what);
  template <class Value>
  void add(std::string name, Value value) {
    if constexpr (std::is_integral_v<Value>) {
      facts.push_back({std::move(name), static_cast<std::int64_t>(value)});
    } else if constexpr (std::is_floating_point_v<Value>) {
      facts.push_back({std::move(name), static_cast<double>(value)});
    } else {
      facts.push_back({std::move(name), std::string(std::move(value))});
    }
  }
};

/// The exit code of a whole examination: of the first stage that failed, else 0.
[[nodiscard]] exit_code exit_code_of(std::span<const stage_report> stages);

}  // namespace g4_dump
