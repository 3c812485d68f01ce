// SPDX-License-Identifier: MIT
// ^C, SIGTERM and SIGHUP as something a loop can ask for and a poll can wait for; how long it waits.
#pragma once

#include <algorithm>
#include <chrono>
#include <string>

namespace g4_tool {

/// A moment that does not come.
inline constexpr auto no_deadline = std::chrono::steady_clock::time_point::max();

/// From now on the first such signal is only stored, a second one ends the program, and writing to a
/// closed pipe or beyond the largest file is an error like any other. Descriptors 0 to 2 that are closed lead
/// nowhere, so that no file takes their place.
void prepare_process();

/// The signal that came, or 0.
[[nodiscard]] int interrupt() noexcept;

/// The exit code of a command that came to its end: 0, or after a signal 128 + its number.
[[nodiscard]] int exit_code_now() noexcept;

/// For poll(): readable when a signal has come.
[[nodiscard]] int interrupt_handle() noexcept;

/// Thrown where a signal came while there was nothing yet to be brought to a good end.
struct interrupted {};

/// What wait_for_input() saw.
enum class wake { input, interrupt, output_closed, timeout };

/// Waits until `input` can be read, a signal comes, the reader of `output` has gone, or the time has
/// come. A descriptor below 0 is not waited for.
[[nodiscard]] wake wait_for_input(
    int input, int output, std::chrono::steady_clock::time_point until = no_deadline) noexcept;

/// open(2), again after a signal that ends nothing; -1 with errno. Throws interrupted.
[[nodiscard]] int open_file(const std::string& name, int flags);

/// When a loop ends by -d and --idle.
class time_limits {
 public:
  using clock = std::chrono::steady_clock;

  /// 0: no limit.
  time_limits(std::chrono::nanoseconds duration, std::chrono::nanoseconds idle) noexcept
      : duration_(duration), idle_(idle) {}

  /// Something has come: --idle counts from now on.
  void came() noexcept { last_ = clock::now(); }
  /// When it ends, if nothing comes until then.
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
