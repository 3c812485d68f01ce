// SPDX-License-Identifier: MIT
// The options that the verbs share, and their rows in the table. A verb takes the rows that mean
// something for it.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "g4lidar/point.hpp"
#include "point_style.hpp"
#include "values.hpp"
#include "verb.hpp"

namespace g4_dump {

/// What stands in the place of a time.
enum class time_style : unsigned char {
  absolute,   ///< Since 1970, by the system's clock.
  monotonic,  ///< Of the monotonic clock, as the library has it.
  delta,      ///< Since the record before.
  zero,       ///< Since the first record.
};

/// What becomes of a command whose device is not there.
enum class loss_rule : unsigned char {
  exit,       ///< It ends.
  reconnect,  ///< It goes on when a device that was there is back.
  wait,       ///< It also waits for one that is not there yet.
};

struct common_options {
  std::string source;        ///< Empty: the only G4.
  std::string output = "-";  ///< `-`: standard output.
  std::uint32_t baud = 230400;
  std::uint64_t count = 0;               ///< So many records, then the end; 0: no end.
  std::chrono::nanoseconds duration{0};  ///< 0: no end.
  std::chrono::nanoseconds idle{0};      ///< The end when nothing has come for so long; 0: never.
  number_range range_m{0.0, 1e9};
  number_range fov_deg{-360.0, 360.0};  ///< In the frame that is written.
  std::vector<number_range> ignore_deg;
  g4lidar::frame frame = g4lidar::frame::vendor;
  length_unit unit = length_unit::millimetres;
  std::optional<time_style> time;  ///< Where nothing is said, what suits the source.
  loss_rule on_loss = loss_rule::exit;
};

using shared_options = std::shared_ptr<common_options>;

/// The words of lidar_options::device, a file, `-`, or `sim:`; see source.hpp.
[[nodiscard]] argument_row source_argument(const shared_options& options);
[[nodiscard]] option_row output_row(const shared_options& options);
/// -n, -d, --idle.
[[nodiscard]] std::vector<option_row> ending_rows(const shared_options& options);
/// --range, --fov, --ignore.
[[nodiscard]] std::vector<option_row> filter_rows(const shared_options& options);
/// --frame, --unit, --time.
[[nodiscard]] std::vector<option_row> shape_rows(const shared_options& options);
[[nodiscard]] option_row baud_row(const shared_options& options);
/// --baud and --on-loss.
[[nodiscard]] std::vector<option_row> device_rows(const shared_options& options);

}  // namespace g4_dump
