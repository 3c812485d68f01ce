// SPDX-License-Identifier: MIT
// Registered simulated lidars, as ports.
#pragma once

#include <vector>

#include "g4lidar/discovery.hpp"

namespace g4lidar {

/// Appends the simulated lidars in the directory that the environment variable G4LIDAR_SIM_DIR names:
/// each symbolic link in it that leads to a pseudo-terminal which a running simulator serves. Without the
/// variable there are none.
void append_simulated_ports(std::vector<port_info>& ports);

}  // namespace g4lidar
