// SPDX-License-Identifier: MIT
// All points in one file for other programs: NumPy arrays, PLY, and plain coordinates.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "g4lidar/point.hpp"
#include "point_writer.hpp"

namespace g4_tool {

/// The formats. All numbers are little-endian.
enum class point_file_format : std::uint8_t {
  /// NumPy: one structured array of all points with the fields angle_deg (float32, the device's frame), range_mm
  /// (float32, 0: no return), time_ns (int64), revolution and flags (uint32; flags are point_flags).
  npy,
  npz,  ///< NumPy: a ZIP file with the same array, named `points`, not compressed.
  /// PLY 1.0, binary: the returns as vertices with x, y, z (z is 0), range_m and angle_deg (float, in the frame of the
  /// file), time_s (double, point::time_ns in seconds), revolution (uint) and, if asked for, intensity (float).
  ply,
  xyz,  ///< Text: the returns, `x y z` in metres, one line each; z is 0.
};

/// A writer whose first bytes are only known at the end, because they contain the number of points.
class point_file_writer : public point_writer {
 public:
  [[nodiscard]] bool takes_scans() const noexcept final { return false; }
  /// Writes what follows the last point. Call it once, also if there was no point.
  virtual void end(text_sink& out) = 0;
  /// The first bytes of the file, after end(): write them over those that begin() wrote, which are as many. Empty if
  /// these stay.
  [[nodiscard]] virtual std::string first_bytes() const = 0;
};

/// The writer for `format`, of points of a lidar like `model`. `to` is the frame of ply and xyz; ply has
/// the intensity of models that have it.
[[nodiscard]] std::unique_ptr<point_file_writer> make_point_file_writer(
    point_file_format format, frame to, const model& model = g4_model);

}  // namespace g4_tool
