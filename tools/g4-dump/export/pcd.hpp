// SPDX-License-Identifier: MIT
// Points as a point cloud: a PCD 0.7 file.
#pragma once

#include <cstdint>
#include <span>

#include "g4lidar/point.hpp"
#include "g4lidar/scan.hpp"
#include "io/text_sink.hpp"

namespace g4_tool {

using namespace g4lidar;

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
/// | `intensity` | float | point::intensity, of models that have it |
///
/// The points are those of a lidar like `model`, which also has the turn of its frame.
void write_pcd(std::span<const point> points, frame to, pcd_data data, text_sink& out,
               const model& model = g4_model);
/// The same for the points of a scan.
inline void write_pcd(const scan& source, frame to, pcd_data data, text_sink& out) {
  write_pcd(source.points, to, data, out, *source.model);
}

}  // namespace g4_tool
