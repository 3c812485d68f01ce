// SPDX-License-Identifier: MIT
// What goes over the line, both ways, as lines for people: the verb packets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/bytes.hpp"
#include "g4lidar/packet.hpp"
#include "g4lidar/response.hpp"
#include "g4lidar/stream_counts.hpp"
#include "g4lidar/stream_parser.hpp"
#include "output.hpp"
#include "point_shaper.hpp"

namespace g4_dump {

struct log_style {
  bool hex = false;         ///< All bytes of everything.
  bool errors = false;      ///< Only what was skipped or is suspect.
  bool has_times = true;    ///< Else lines begin with the place of the bytes in the input.
  std::uint64_t lines = 0;  ///< So many, then no more; 0: no end.
};

/// Takes bytes as they went over the line and writes a line for each thing in them. *Single thread.*
class protocol_log {
 public:
  /// `out` outlives this. Times are shifted by `times`.
  protocol_log(const log_style& style, const time_shift& times, output& out)
      : style_(style), times_(times), out_(out) {}

  void from_device(g4lidar::bytes data, std::int64_t time_ns);
  void to_device(g4lidar::bytes data, std::int64_t time_ns);
  /// Something else that is to be known: "opened /dev/ttyUSB0".
  void remark(std::string_view words, std::int64_t time_ns);
  /// No more bytes follow those so far: the line was lost, or has ended.
  void finish();
  /// Writes what waits for more of its kind.
  void settle();

  [[nodiscard]] bool is_done() const noexcept { return style_.lines > 0 && lines_ >= style_.lines; }
  [[nodiscard]] const g4lidar::stream_counts& counts() const noexcept { return counts_; }
  [[nodiscard]] std::uint64_t bytes_from_device() const noexcept { return bytes_; }
  [[nodiscard]] std::uint64_t commands() const noexcept { return commands_; }

 private:
  void take(const g4lidar::event& found);
  void take(g4lidar::packet_view packet);
  void take(g4lidar::response_view response);
  void take(g4lidar::skipped gone);
  [[nodiscard]] std::string meaning_of(g4lidar::response_view response) const;
  /// `mark`: > to the device, < from it, ! nothing that can be read.
  void write_line(char mark, std::string_view words, g4lidar::bytes data, std::int64_t time_ns,
                  std::uint64_t place);

  log_style style_;
  time_shift times_;
  output& out_;
  g4lidar::stream_parser parser_;
  g4lidar::stream_counts counts_;
  std::vector<std::uint8_t> pending_;  // came from the device, and all of it behind taken_
  std::size_t taken_ = 0;              // is in no event yet
  std::vector<std::uint8_t> skipped_;  // not written yet, one reason
  g4lidar::skip_reason reason_ = g4lidar::skip_reason::noise;
  std::int64_t skipped_ns_ = 0;
  std::int64_t now_ns_ = 0;
  std::uint64_t place_ = 0;  // of what comes next
  std::uint64_t bytes_ = 0;
  std::uint64_t commands_ = 0;
  std::uint64_t lines_ = 0;
  std::uint8_t asked_ = 0;  // the last command
};

}  // namespace g4_dump
