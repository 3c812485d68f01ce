// SPDX-License-Identifier: MIT
// The exit codes, and the exception that ends a command with an error, in the words of the tool.
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "g4lidar/error.hpp"

namespace g4_tool {

using namespace g4lidar;

/// The exit codes of g4-dump; they do not change. A command that a signal ends exits with 128 + the
/// number of the signal.
enum class exit_code : int {
  ok = 0,
  usage = 2,       ///< The command line is not valid.
  no_device = 3,   ///< No port, no lidar, or several and none was chosen.
  permission = 4,  ///< This user may not open the port.
  busy = 5,        ///< Another program has opened the port.
  silent = 6,      ///< No valid answer: in most cases a wrong baud rate.
  not_a_g4 = 7,    ///< Another device answers.
  unhealthy = 8,   ///< The device reports an error or does not obey.
  lost = 9,        ///< The connection was lost.
  bad_file = 10,   ///< A file cannot be read or written, or contains no usable data.
  internal = 11,   ///< Out of memory, or an error of the program.
};

/// The exit code for a problem that has ended a command. `was_running`: points were received before.
[[nodiscard]] exit_code exit_code_for(const g4lidar::error& why, bool was_running = false) noexcept;

/// A text in errors and advice of the library that addresses programmers, and its replacement for
/// users of the tool.
struct tool_word {
  std::string_view library;
  std::string_view tool;
};
[[nodiscard]] std::span<const tool_word> tool_words() noexcept;

/// `text` with all of them replaced.
[[nodiscard]] std::string in_tool_words(std::string_view text);

/// Ends a command with an error: whole sentences with the cause and what to try.
class failure : public std::runtime_error {
 public:
  /// `problem`: its name in the library, if it is one of the library's problems.
  failure(exit_code code, const std::string& sentences, std::string_view problem = {})
      : std::runtime_error(sentences), code_(code), problem_(problem) {}
  /// An error of the library, in the words of the tool.
  explicit failure(const g4lidar::error& why, bool was_running = false)
      : std::runtime_error(in_tool_words(why.message())),
        code_(exit_code_for(why, was_running)),
        problem_(name_of(why.code())) {}

  [[nodiscard]] exit_code code() const noexcept { return code_; }
  /// The problem's name in docs/errors.md; empty if it is not one of the library's problems.
  [[nodiscard]] std::string_view problem() const noexcept { return problem_; }

 private:
  exit_code code_;
  std::string_view problem_;
};

/// The value of a result of the library. Throws a failure if it is an error.
template <class Value>
Value value_of(result<Value> given) {
  if (!given) throw failure(given.error());
  if constexpr (!std::is_void_v<Value>) return *std::move(given);
}

}  // namespace g4_tool
