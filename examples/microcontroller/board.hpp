// SPDX-License-Identifier: MIT
// The functions that the program needs from a board: for another board, write another board.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace board {

/// Initialises both serial ports and the timer. From then on it calls on_lidar_byte().
void begin();

/// Milliseconds since begin(), in nanoseconds. For the main loop only, at least once in 49 days.
[[nodiscard]] std::int64_t now_ns();

/// Sends to the lidar; waits until the last byte is in the transmitter.
void send(std::span<const std::uint8_t> bytes);

/// Writes to the console, in the same way.
void print(std::string_view text);

/// Sleeps until the next interrupt, at most a millisecond.
void sleep();

/// How many bytes the receiver dropped because the interrupt was too late.
[[nodiscard]] std::uint32_t receiver_overruns();

/// Ends the program, if that is possible: in an emulator.
[[noreturn]] void end(int code);

}  // namespace board

/// Implemented by the program: the interrupt calls it with each byte from the lidar.
void on_lidar_byte(std::uint8_t byte);
