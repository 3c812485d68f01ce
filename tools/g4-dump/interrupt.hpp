// SPDX-License-Identifier: MIT
// ^C, SIGTERM and SIGHUP as something a loop can ask for and a poll can wait for.
#pragma once

namespace g4_dump {

/// From now on the first such signal is only noted, a second one ends the program, and writing to a
/// closed pipe or beyond the largest file is an error like any other. Descriptors 0 to 2 that are closed lead nowhere, so that
/// no file comes to stand in their place.
void prepare_process();

/// The signal that came, or 0.
[[nodiscard]] int interrupt() noexcept;

/// For poll(): readable when a signal has come.
[[nodiscard]] int interrupt_handle() noexcept;

/// Thrown where a signal came while there was nothing yet to be brought to a good end.
struct interrupted {};

/// What wait_for_input() saw.
enum class wake { input, interrupt, output_closed, timeout };

/// Waits until `input` can be read, a signal comes, the reader of `output` has gone, or so many
/// milliseconds have passed; -1: for ever.
[[nodiscard]] wake wait_for_input(int input, int output, int timeout_ms = -1) noexcept;

/// Whether reading `input` would have to wait.
[[nodiscard]] bool would_wait(int input) noexcept;

}  // namespace g4_dump
