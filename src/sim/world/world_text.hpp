// SPDX-License-Identifier: MIT
// Words and numbers in the lines of a world.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace g4lidar::sim {

/// Takes the next word from the front of `line`; empty at its end.
[[nodiscard]] std::string_view next_word(std::string_view& line) noexcept;

/// A word for an error message, safe to print.
[[nodiscard]] std::string quoted(std::string_view word, std::size_t enough = 24);

/// How many numbers were read, or the error.
struct numbers_read {
  std::size_t count = 0;
  std::optional<std::string> wrong;
};

/// Parses the rest of a line, at least `least` numbers and at most as many as `out` holds.
[[nodiscard]] numbers_read read_numbers(std::string_view rest, std::span<double> out,
                                        std::size_t least, std::string_view form);

/// The same for exactly as many as `out` holds.
[[nodiscard]] std::optional<std::string> numbers(std::string_view rest, std::span<double> out,
                                                 std::string_view form);

/// Whether one of them is beyond max_coordinate_m.
[[nodiscard]] bool too_far(std::span<const double> coordinates) noexcept;

inline constexpr const char* too_far_message = "no coordinate may be beyond 1000 m";
inline constexpr const char* heading_message = "the heading must be -360 to 360 degrees";

}  // namespace g4lidar::sim
