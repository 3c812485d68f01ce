// SPDX-License-Identifier: MIT
// Points or revolutions of any lidar, recording or raw bytes to a file: what dump, scan, decode, replay and convert do.
#pragma once

#include "point_output.hpp"

namespace g4_tool {

/// Returns the exit code; throws a failure or a bad_value.
[[nodiscard]] int run(const point_options& options);

}  // namespace g4_tool
