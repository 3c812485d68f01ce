// SPDX-License-Identifier: MIT
// A driver whose device is unplugged again and again, in virtual time.
#pragma once

#include <cstdint>
#include <string>

namespace g4lidar::simulation {

struct soak_report {
  std::string failure;  ///< Empty if nothing failed.
  std::uint64_t unplugs = 0;
  std::uint64_t reconnects = 0;
  std::int64_t slowest_ns = 0;     ///< From the plug to the next whole revolution.
  std::int64_t grown_bytes = 0;    ///< Memory in use between an early unplug and the last.
  std::int64_t grown_handles = 0;  ///< And open descriptors.
};

/// Unplugs so often, each time at another moment, and plugs in again.
[[nodiscard]] soak_report soak(std::uint64_t unplugs);

}  // namespace g4lidar::simulation
