// SPDX-License-Identifier: MIT
// Whether it is another program that spoils the talk with a device.
#pragma once

#include "g4lidar/error.hpp"
#include "g4lidar/transport.hpp"

namespace g4lidar {

/// `why`, or interference in its place where another program has the port open, or has changed its
/// settings, and that can be the reason. Looks through all processes; allocates.
[[nodiscard]] error with_rivals(const error& why, const transport& line) noexcept;

}  // namespace g4lidar
