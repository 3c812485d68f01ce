// SPDX-License-Identifier: MIT
// The bytes that a lidar has sent, copied from a recording or from raw bytes.
#pragma once

#include <cstdint>

#include "io/output.hpp"
#include "io/point_output.hpp"

namespace g4_tool {

/// Writes the bytes that the lidar sent. Returns their number.
std::uint64_t copy_recording(const point_options& options, output& out);

/// Writes a part of raw bytes; their times are counted. Returns the number of those that were wanted.
std::uint64_t copy_bytes(const point_options& options, output& out);

}  // namespace g4_tool
