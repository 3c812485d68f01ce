// SPDX-License-Identifier: MIT
// The loop of a command that reads raw bytes: to their end, a signal, or until it has had enough.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <span>

#include "input.hpp"
#include "output.hpp"

namespace g4_dump {

/// What becomes of the bytes, and when there have been enough of them.
struct byte_sink {
  std::function<void(std::span<const std::uint8_t>)> take;
  std::function<bool()> is_done{};       ///< Asked after each piece, where it is set.
  std::chrono::nanoseconds duration{0};  ///< Of a pipe, so long at most; 0: no end.
  std::chrono::nanoseconds idle{0};      ///< Of a pipe, the end when nothing came; 0: never.
  bool with_bar = true;                  ///< Whether to show how far a file has been read.
};

/// Pumps until one of these ends, the end of the input, a signal, or nobody reads `out` any more. Who
/// reads `out` has all there is before more is waited for, and the first of a file at once.
void pump(input& in, output& out, const byte_sink& sink);

}  // namespace g4_dump
