// SPDX-License-Identifier: MIT
// What `sim:?NAME=VALUE&...` means as the name of a lidar.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/sim/odometry.hpp"
#include "g4lidar/sim/pty_port.hpp"
#include "g4lidar/sim/world.hpp"

namespace g4lidar::sim {

/// A simulated lidar in real time, and the robot that carries it.
struct simulated_source {
  std::shared_ptr<background_pty> port;
  std::optional<odometry> robot;  ///< Without errors; nothing without a path.
  std::int64_t begin_ns;          ///< The time 0 of both, by std::chrono::steady_clock.
  std::string model;              ///< Its word; empty: a G4.
  pose mounted_at{};              ///< As in world.
};

/// The lidar that "sim:?NAME=VALUE&..." describes, at a port as that of
/// serve_alone(). Fails with bad_option if this is no
/// setup, with bad_file if the world or the path is none, or with system; the subject has the reason.
[[nodiscard]] G4LIDAR_API result<simulated_source> open_simulated(std::string_view source);

}  // namespace g4lidar::sim
