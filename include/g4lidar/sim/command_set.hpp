// SPDX-License-Identifier: MIT
// The commands that a simulated device has.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>

#include "g4lidar/detail/cpp20.hpp"

namespace g4lidar::sim {

/// Commands by their second byte. A device does not answer what it does not have. *Single thread.*
class command_set {
 public:
  /// Those of `codes`.
  constexpr command_set(std::initializer_list<std::uint8_t> codes) noexcept {
    for (const std::uint8_t code : codes) add(code);
  }

  /// Whether it contains the command.
  [[nodiscard]] constexpr bool has(std::uint8_t code) const noexcept {
    return (words_[code / 64U] >> code % 64U & 1U) != 0;
  }
  /// Adds a command.
  constexpr void add(std::uint8_t code) noexcept {
    words_[code / 64U] |= std::uint64_t{1} << code % 64U;
  }
  /// Adds all of `others`.
  constexpr void add(const command_set& others) noexcept {
    for (std::size_t i = 0; i < words_.size(); ++i) words_[i] |= others.words_[i];
  }

  friend constexpr bool operator==(const command_set&, const command_set&) = default;

 private:
  std::array<std::uint64_t, 4> words_{};
};

/// Those of every model that answers: stop, start, restart, information, health.
inline constexpr command_set basic_commands{0x00, 0x40, 0x60, 0x65, 0x80, 0x90, 0x91, 0x92};
/// The scan frequency.
inline constexpr command_set frequency_commands{0x09, 0x0A, 0x0B, 0x0C, 0x0D};
/// All those of a G4.
inline constexpr command_set g4_commands = [] {
  command_set all{0x01, 0x02, 0x05, 0x06, 0x07, 0x08, 0x0E, 0x0F, 0xD0, 0xD1, 0xD9};
  all.add(basic_commands);
  all.add(frequency_commands);
  return all;
}();

}  // namespace g4lidar::sim
