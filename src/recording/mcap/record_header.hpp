// SPDX-License-Identifier: MIT
// How records begin, and whether bytes can be the beginning of one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "format.hpp"
#include "g4lidar/core/bytes.hpp"

namespace g4lidar::mcap {

struct record_header {
  opcode kind;
  std::uint64_t length;  ///< Of its content.
};

inline constexpr std::size_t data_end_length = 4;

/// Whether a record can begin like this, where `left` bytes of the file follow. Chunks, which are searched for, have
/// several fields to check.
[[nodiscard]] std::optional<record_header> believe(bytes begin, std::uint64_t left) noexcept;

}  // namespace g4lidar::mcap
