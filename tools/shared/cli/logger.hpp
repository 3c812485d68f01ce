// SPDX-License-Identifier: MIT
// The messages of the program, a status line and a progress bar, on standard error.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "exit_code.hpp"
#include "g4lidar/export/printable.hpp"

namespace g4_tool {

using g4lidar::printable;

/// `name` as it stands in sentences.
[[nodiscard]] inline std::string in_quotes(const std::string& name) { return "'" + name + "'"; }

/// How many there are of something: "1 packet", "0 packets", "2 packets".
[[nodiscard]] std::string counted(unsigned long long number, std::string_view noun);

/// Words in lines that fit a terminal. The first begins at `column`, all others after `indent`
/// blanks.
[[nodiscard]] std::string wrapped(std::string_view words, std::size_t column, std::size_t indent);

/// One line of JSON. Everything but ASCII is escaped, and what is not UTF-8 is replaced.
[[nodiscard]] std::string json_line(const nlohmann::ordered_json& value);

/// A line of a terminal that is drawn over, ten times a second, and wiped away at the end. With -q, and
/// where standard error is not a terminal, nothing is drawn.
class status_line {
 public:
  explicit status_line(bool wanted);
  status_line(const status_line&) = delete;
  status_line& operator=(const status_line&) = delete;
  ~status_line() { clear(); }

  /// Whether draw() is to be called now.
  [[nodiscard]] bool is_due();
  void draw(std::string_view text);
  void clear();
  /// How long it has been there.
  [[nodiscard]] double seconds() const;

 private:
  using clock = std::chrono::steady_clock;

  bool on_;
  bool drawn_ = false;
  clock::time_point begin_ = clock::now();
  clock::time_point next_ = begin_;
};

/// Shows how much of a known number of bytes is done.
class progress_bar {
 public:
  /// Below this many bytes it is over before anybody has read the bar.
  static constexpr std::uint64_t least_bytes = 16'000'000;

  explicit progress_bar(std::uint64_t all_bytes, bool wanted = true)
      : line_(wanted && all_bytes >= least_bytes), all_(all_bytes) {}

  void show(std::uint64_t done_bytes);

 private:
  status_line line_;
  std::uint64_t all_;
};

}  // namespace g4_tool

/// Each line of a message passes through printable(). A message that cannot be written is dropped.
namespace g4_tool::logger {

/// A message with its line breaks; not with -q.
void info(std::string_view message);
/// A message with its line breaks; with -v only.
void verbose(std::string_view message);
/// "PROGRAM: SENTENCES", or with --json-errors {"error":SENTENCES,"problem":...,"exit_code":N}.
void error(std::string_view sentences, exit_code code, std::string_view problem = {});
/// Bytes as they are, whatever the options: for lines that are drawn over, and for output that the
/// user asked for on standard error.
void write(std::string_view text) noexcept;

}  // namespace g4_tool::logger
