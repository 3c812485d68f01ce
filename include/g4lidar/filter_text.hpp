// SPDX-License-Identifier: MIT
// Filters and mountings as text: the values of parameters, and of the options of programs.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "g4lidar/core/angle.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/filter.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/scan_shaper.hpp"

namespace g4lidar {

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
