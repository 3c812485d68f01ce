// SPDX-License-Identifier: MIT
// Points as a point cloud: a PCD 0.7 file.
#pragma once

#include <cstdint>
#include <span>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/export/text_sink.hpp"
#include "g4lidar/point.hpp"

namespace g4lidar {

/// The encoding of the fields of a cloud.
enum class pcd_data : std::uint8_t {
  binary,  ///< Little-endian, 28 bytes per point, 32 with intensity.
  ascii,   ///< One line per point, numbers with all their digits.
};

/// Writes one complete file: the returns among `points`, in their order. Fields, without padding:
///
/// | field | type | meaning |
/// |---|---|---|
/// | `x`, `y`, `z` | float | metres in frame `to` (point.hpp); z is 0 |
/// | `range_m` | float | metres |
/// | `angle_deg` | float | degrees in frame `to`: vendor in [0, 360), robot in [-180, 180) |
/// | `time_ns` | 64-bit signed integer | point::time_ns |
/// | `intensity` | float | point::intensity, if `has_intensity` |
G4LIDAR_API void write_pcd(std::span<const point> points, frame to, pcd_data data, text_sink& out,
                           bool has_intensity = false);

}  // namespace g4lidar
