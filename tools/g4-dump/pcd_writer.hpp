// SPDX-License-Identifier: MIT
// Revolutions as point clouds, a PCD 0.7 file for each: --format pcd.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "g4lidar/point.hpp"
#include "output.hpp"
#include "point_writer.hpp"

namespace g4_dump {

enum class pcd_data : unsigned char { binary, ascii };

/// Writes a whole cloud: the returns among `points`, whose angles are in `frame` as degrees in
/// [0, 360). Fields: x y z range_m (float, metres), angle_deg (float), time_ns (64-bit integer).
void write_pcd(std::span<const g4lidar::point> points, g4lidar::frame frame, pcd_data data,
               output& out);

/// The files that a name stands for: `scan-%04d.pcd` and a directory stand for one for each number.
class numbered_files {
 public:
  /// Nothing where `name` is the name of one file. Throws a bad_value where it makes no sense.
  [[nodiscard]] static std::optional<numbered_files> from(const std::string& name);
  /// The name of file `number`.
  [[nodiscard]] std::string name_of(std::uint64_t number) const;

 private:
  std::string before_;
  int width_ = 0;
  std::string after_;
};

/// Each revolution goes to `out`, or to a file of its own.
[[nodiscard]] std::unique_ptr<point_writer> make_pcd_writer(
    g4lidar::frame frame, pcd_data data, const std::optional<numbered_files>& files);

}  // namespace g4_dump
