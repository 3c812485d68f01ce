// SPDX-License-Identifier: MIT
// What the program asks of a board: to carry it over to another one, write another board.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace board {

/// Sets up both serial lines and the timer. From now on on_lidar_byte() is called.
void begin();

/// Milliseconds since begin(), in nanoseconds. The main loop only, once in 49 days at least.
[[nodiscard]] std::int64_t now_ns();

/// Sends to the lidar; waits until the last byte has gone into the transmitter.
void send(std::span<const std::uint8_t> bytes);

/// Writes to the console, likewise.
void say(std::string_view text);

/// Sleeps until the next interrupt, a millisecond at most.
void sleep();

/// How often the lidar's receiver had to drop a byte, since the interrupt came too late.
[[nodiscard]] std::uint32_t receiver_overruns();

/// The end, where there is one: in an emulator.
[[noreturn]] void end(int code);

}  // namespace board

/// The program's part: called from the interrupt with each byte from the lidar.
void on_lidar_byte(std::uint8_t byte);
