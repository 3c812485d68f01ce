// SPDX-License-Identifier: MIT
// The results of a moved-from lidar or reader.
#pragma once

#include "g4lidar/lidar.hpp"

namespace g4lidar {

[[nodiscard]] inline tl::unexpected<error> moved_from() noexcept {
  return failure(task::reading, problem::gone, "this lidar, which was moved from");
}

/// A ring that is never written to. Not const: then it takes no space in the program file.
[[nodiscard]] inline const lidar_ring& empty_ring() noexcept {
  static constinit lidar_ring ring;
  return ring;
}

}  // namespace g4lidar
