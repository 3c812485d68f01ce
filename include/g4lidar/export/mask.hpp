// SPDX-License-Identifier: MIT
// The parts of a robot that its lidar sees, as polygons from a text file.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/polygon.hpp"

namespace g4lidar {

/// Polygons and their memory, for point_filter::masks. Only movable: polygons() views it.
class mask {
 public:
  /// Without a polygon.
  mask() = default;
  /// The other one is empty afterwards.
  mask(mask&&) noexcept = default;
  /// The same.
  mask& operator=(mask&&) noexcept = default;
  mask(const mask&) = delete;
  mask& operator=(const mask&) = delete;
  ~mask() = default;

  /// The polygons in their order. Valid as long as this object, or that to which it was moved.
  [[nodiscard]] std::span<const polygon> polygons() const noexcept { return polygons_; }
  /// Adds a polygon with these corners.
  void add(std::vector<corner> corners) {
    polygons_.emplace_back(outlines_.emplace_back(std::move(corners)));
  }

 private:
  std::vector<std::vector<corner>> outlines_;
  std::vector<polygon> polygons_;
};

/// Why a text is not a mask.
struct mask_error {
  std::size_t line;     ///< Counted from 1; 0 if a required statement is missing.
  std::string message;  ///< One sentence without the line number, for people.
};

/// The maximum number of polygons in a mask.
inline constexpr std::size_t max_mask_polygons = 1000;
/// The maximum number of corners of each.
inline constexpr std::size_t max_mask_corners = 1000;
/// The maximum of each coordinate of a mask, in magnitude.
inline constexpr double max_mask_coordinate_m = 100.0;

/// The mask that `text` describes, or the first error in it. Each line is empty, or
/// `polygon x1 y1 x2 y2 x3 y3 ...`: the corners in metres, at least three, in frame::robot; from `#`
/// on a line is a comment. At least one polygon. Independent of the locale. Throws only
/// std::bad_alloc.
[[nodiscard]] G4LIDAR_API std::variant<mask, mask_error> parse_mask(std::string_view text);

/// The mask in the file at `path`; without a path, one without polygons. Else why there is none, and what to do, for
/// people: "mask: '/tmp' is a directory. Give a file ...". Never waits: a pipe or a device is refused. A file has at most
/// 16 MiB. Throws only std::bad_alloc.
[[nodiscard]] G4LIDAR_API std::variant<mask, std::string> load_mask(const std::string& path);

}  // namespace g4lidar
