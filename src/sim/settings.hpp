// SPDX-License-Identifier: MIT
// What commands do to the memory of a simulated G4, and the bytes of its answers.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "g4lidar/bytes.hpp"
#include "g4lidar/sim/device_options.hpp"

namespace g4lidar::sim {

/// The bytes of one answer.
struct answer_bytes {
  std::array<std::uint8_t, response_header_size + max_response_content> data{};
  std::uint8_t size = 0;

  [[nodiscard]] bytes view() const noexcept { return bytes(data).first(size); }
};

[[nodiscard]] answer_bytes answer_with(response_kind kind, bytes content) noexcept;
[[nodiscard]] answer_bytes answer_with(const device_information& info) noexcept;
[[nodiscard]] answer_bytes answer_with(const health& condition) noexcept;

/// The settings of a device that has just got its power.
[[nodiscard]] device_settings first_settings(const device_options& options) noexcept;

/// Carries out a command that reads or changes a setting: its answer. Nothing for other commands,
/// and where the options say that it goes unanswered.
[[nodiscard]] std::optional<answer_bytes> apply(command code, device_settings& settings,
                                                const device_options& options) noexcept;

}  // namespace g4lidar::sim
