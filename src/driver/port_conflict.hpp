// SPDX-License-Identifier: MIT
// Detects another process that disturbs the communication with a device.
#pragma once

#include "g4lidar/error.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar {

/// `why`; or interference instead, if another process has the port open or has changed its
/// settings, and `why` can be a result of that. Examines all processes; allocates.
[[nodiscard]] error with_port_conflict(const error& why, const transport& port) noexcept;

}  // namespace g4lidar
