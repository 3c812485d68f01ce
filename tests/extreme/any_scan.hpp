// SPDX-License-Identifier: MIT
// Scans and grids of extreme values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "g4lidar/grid.hpp"
#include "g4lidar/scan.hpp"
#include "numbers.hpp"

namespace g4lidar::extreme {

inline grid_options any_grid(test::dice& random) {
  return {any<frame>(random),        any<grid_pick>(random), any<bool>(random),
          any<no_return_as>(random), any<bool>(random),      any<std::uint16_t>(random),
          any<float>(random)};
}

inline scan any_scan(test::dice& random, const std::vector<point>& points) {
  scan made;
  made.points = points;
  made.revolution = any<std::uint32_t>(random);
  made.flags = any<scan_flags>(random);
  made.reported_frequency_chz = any<std::uint16_t>(random);
  made.sample_rate_hz = any<std::uint32_t>(random);
  made.turned_deg = any<float>(random);
  made.duration_ns = any<std::int64_t>(random);
  made.model = &models[random.below(models.size())];
  return made;
}

}  // namespace g4lidar::extreme
