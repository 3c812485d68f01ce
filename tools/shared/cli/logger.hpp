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
#include "g4lidar/error.hpp"

namespace g4_tool {

using g4lidar::printable;

/// `name` in quotation marks, for sentences.
[[nodiscard]] inline std::string in_quotes(const std::string& name) { return "'" + name + "'"; }

/// A number and its noun: "1 packet", "0 packets", "2 packets".
[[nodiscard]] std::string counted(unsigned long long number, std::string_view noun);

/// Words in lines of at most `width` characters. The first line begins at `column`, all others after
/// `indent` blanks.
[[nodiscard]] std::string wrapped(std::string_view words, std::size_t column, std::size_t indent,
                                  std::size_t width = 98);

/// One line of JSON in ASCII, with escapes. Invalid UTF-8 is replaced.
[[nodiscard]] std::string json_line(const nlohmann::ordered_json& value);

/// A line of a terminal that is replaced ten times a second and erased at the end. With -q, or if
/// standard error is not a terminal, nothing is drawn.
class status_line {
 public:
  explicit status_line(bool wanted);
  status_line(const status_line&) = delete;
  status_line& operator=(const status_line&) = delete;
  ~status_line() { clear(); }

  /// Whether it is time to call draw().
  [[nodiscard]] bool is_due();
  void draw(std::string_view text);
  void clear();
  /// The time since its construction.
  [[nodiscard]] double seconds() const;

 private:
  using clock = std::chrono::steady_clock;

  bool on_;
  bool drawn_ = false;
  clock::time_point begin_ = clock::now();
  clock::time_point next_ = begin_;
};

/// Shows the progress through a known number of bytes.
class progress_bar {
 public:
  /// For fewer bytes no bar is shown, because they take too little time.
  static constexpr std::uint64_t least_bytes = 16'000'000;

  explicit progress_bar(std::uint64_t all_bytes, bool wanted = true)
      : line_(wanted && all_bytes >= least_bytes), all_(all_bytes) {}

  void show(std::uint64_t done_bytes);

 private:
  status_line line_;
  std::uint64_t all_;
};

}  // namespace g4_tool

/// Each line of a message passes through printable(). Messages that cannot be written are dropped.
namespace g4_tool::logger {

/// Writes a message with its line breaks; not with -q.
void info(std::string_view message);
/// Writes a message with its line breaks; with -v only.
void verbose(std::string_view message);
/// "PROGRAM: SENTENCES", or with --json-errors {"error":SENTENCES,"problem":...,"exit_code":N}.
void error(std::string_view sentences, exit_code code, std::string_view problem = {});
/// Writes bytes unchanged, whatever the options: for status lines, and for output that the user
/// requested on standard error.
void write(std::string_view text) noexcept;

}  // namespace g4_tool::logger
