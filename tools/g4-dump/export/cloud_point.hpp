// SPDX-License-Identifier: MIT
// A point as the point clouds contain it, and numbers as their bytes.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "g4lidar/core/angle.hpp"
#include "g4lidar/point.hpp"

namespace g4_tool {

using namespace g4lidar;

struct cloud_point {
  float x_m;
  float y_m;
  float range_m;
  float angle_deg;  ///< Vendor in [0, 360), robot in [-180, 180).
};

/// Writes the bytes of a number, the lowest first.
template <class Number>
char* put_little_endian(char* out, Number number) noexcept {
  auto raw = std::bit_cast<std::array<char, sizeof number>>(number);
  if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
  return std::copy(raw.begin(), raw.end(), out);
}

[[nodiscard]] inline cloud_point in_cloud(const point& p, frame to,
                                          std::uint16_t turn_deg) noexcept {
  const float degrees = bearing_deg(p.angle_deg, to, turn_deg);
  const sine_cosine direction = sine_cosine_deg(degrees);
  const float range_m = p.range_mm / 1000.0F;
  const bool is_signed = to == frame::robot && degrees >= 180.0F;
  return {range_m * direction.cosine, range_m * direction.sine, range_m,
          is_signed ? degrees - 360.0F : degrees};
}

}  // namespace g4_tool
