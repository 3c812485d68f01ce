// SPDX-License-Identifier: MIT
// The effect of commands on the memory of a simulated lidar, and the bytes of its answers.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/core/command.hpp"
#include "g4lidar/core/response.hpp"
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

/// The settings of a device after power-on.
[[nodiscard]] device_settings first_settings(const device_options& options) noexcept;

/// Executes a command that reads or changes a setting, and returns its answer. Nothing for other
/// commands, and if the options state that it is not answered.
[[nodiscard]] std::optional<answer_bytes> apply(command code, device_settings& settings,
                                                const device_options& options) noexcept;

}  // namespace g4lidar::sim
