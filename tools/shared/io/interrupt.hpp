// SPDX-License-Identifier: MIT
// ^C, SIGTERM and SIGHUP as a state for loops and a descriptor for poll(); the time limits of loops.
#pragma once

#include <algorithm>
#include <chrono>
#include <string>

namespace g4_tool {

/// A deadline that never expires.
inline constexpr auto no_deadline = std::chrono::steady_clock::time_point::max();

/// Installs the handlers: the first such signal is only stored, a second one ends the program. Writing
/// to a closed pipe or beyond the largest file size becomes an ordinary error. Closed descriptors from 0
/// to 2 are opened on /dev/null, so that no file gets their numbers.
void prepare_process();

/// The stored signal, or 0.
[[nodiscard]] int interrupt() noexcept;

/// The exit code of a command that has ended without an error: 0, or after a signal 128 + its number.
[[nodiscard]] int exit_code_now() noexcept;

/// For poll(): readable after a signal.
[[nodiscard]] int interrupt_handle() noexcept;

/// Thrown for a signal before there is any output to complete.
struct interrupted {};

/// The result of wait_for_input().
enum class wake { input, interrupt, output_closed, timeout };

/// Waits until `input` is readable, a signal comes, the reader of `output` has closed it, or `until`.
/// Descriptors below 0 are ignored.
[[nodiscard]] wake wait_for_input(
    int input, int output, std::chrono::steady_clock::time_point until = no_deadline) noexcept;

/// open(2), repeated after EINTR; -1 with errno. Throws interrupted after a stored signal.
[[nodiscard]] int open_file(const std::string& name, int flags);

/// The end of a loop by -d and --idle.
class time_limits {
 public:
  using clock = std::chrono::steady_clock;

  /// 0: no limit.
  time_limits(std::chrono::nanoseconds duration, std::chrono::nanoseconds idle) noexcept
      : duration_(duration), idle_(idle) {}

  /// Data has arrived: --idle counts from now on.
  void restart_idle() noexcept { last_ = clock::now(); }
  /// When the loop ends if no data arrives.
  [[nodiscard]] clock::time_point end() const noexcept {
    return std::min(duration_.count() > 0 ? begin_ + duration_ : no_deadline,
                    idle_.count() > 0 ? last_ + idle_ : no_deadline);
  }
  [[nodiscard]] bool is_over() const noexcept { return clock::now() >= end(); }

 private:
  std::chrono::nanoseconds duration_;
  std::chrono::nanoseconds idle_;
  clock::time_point begin_ = clock::now();
  clock::time_point last_ = begin_;
};

}  // namespace g4_tool
