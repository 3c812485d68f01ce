// SPDX-License-Identifier: MIT
// Filters, masks and mountings as text: the values of parameters, and of the options of programs.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "g4lidar/core/angle.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/filter.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/scan_shaper.hpp"

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

/// The filters that set_filter() sets, of a lidar.
struct filter_settings {
  point_filter filter{};          ///< Without its ignored sectors and masks.
  std::vector<sector> ignored{};  ///< In the frame of `filter`.
  mark_limits marks{};
  grid_options grid{};  ///< What ranges without return become; its frame is not used.

  /// The filter with its ignored sectors, a view of this. *Pure.*
  [[nodiscard]] point_filter complete_filter() const noexcept {
    point_filter made = filter;
    made.ignored_sectors = ignored;
    return made;
  }
};

/// Sets a filter by its name:
///
/// | name | text |
/// |---|---|
/// | `range` | the ranges that are kept, m: `0.28:16` |
/// | `range_min`, `range_max` | the least and the greatest one; whether they are in order is not checked |
/// | `fov` | the directions that are kept, degrees in the frame of the filter: `-90:90` |
/// | `ignore` | directions that are left out, with spaces between them: `30:40 90:100`; `off` or nothing: none |
/// | `speckle`, `edges`, `near` | `off`, `on` or nothing, or limits: `window=2,count=1` |
/// | `no_return` | `inf`, `nan` or `max` |
/// | `near_as` | `nan` or `minus-inf` |
///
/// Returns why the text is not valid, and then changes nothing; empty if it is set. Independent of the locale.
[[nodiscard]] G4LIDAR_API std::string set_filter(filter_settings& into, std::string_view name,
                                                 std::string_view text);
/// The words that the text of a filter may have, of speckle, edges and near the names of limits; empty if it has none.
/// *Pure.* Valid forever.
[[nodiscard]] G4LIDAR_API std::span<const std::string_view> filter_words(
    std::string_view name) noexcept;

/// "X,Y,DEG" or "X,Y,DEG,down" in metres and degrees; else why the text is not valid. Independent of the locale.
[[nodiscard]] G4LIDAR_API std::variant<mounting, std::string> mounting_in(std::string_view text);

}  // namespace g4lidar
