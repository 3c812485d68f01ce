// SPDX-License-Identifier: MIT
// Selecting and marking the points of an array.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <initializer_list>
#include <optional>
#include <utility>
#include <vector>

#include "errors.hpp"
#include "g4lidar/filter.hpp"
#include "g4lidar/outliers.hpp"
#include "g4lidar/plausibility.hpp"
#include "g4lidar/too_near.hpp"
#include "scan.hpp"
#include "words.hpp"

namespace g4lidar::python {
namespace {

using namespace nb::literals;
using angles = std::pair<double, double>;
using outline = std::vector<std::pair<float, float>>;

/// What point_filter takes as views.
struct owned_filter {
  point_filter made;
  std::vector<sector> ignored;
  std::vector<std::vector<corner>> corners;
  std::vector<polygon> masks;
};

void require_numbers(std::initializer_list<double> values) {
  for (const double value : values) {
    if (std::isnan(value)) throw nb::value_error("a limit is a number, not NaN");
  }
}

void require_finite(const angles& sector) {
  if (!std::isfinite(sector.first) || !std::isfinite(sector.second))
    raise_impossible("the angles of a sector are finite", sector);
}

array<point> select(const array<point>& points, const std::optional<angles>& field_of_view,
                    const std::vector<angles>& ignored_sectors, const std::vector<outline>& masks,
                    float least_range_mm, float greatest_range_mm, bool returns_only,
                    bool trusted_only, unsigned excluded, frame in, bool for_grid) {
  require_numbers({least_range_mm, greatest_range_mm});
  if (excluded > 0xFFU) raise_impossible("excluded: flags of PointFlag", excluded);
  owned_filter how;
  how.made.in = in;
  if (field_of_view) {
    require_finite(*field_of_view);
    how.made.field_of_view = sector(field_of_view->first, field_of_view->second);
  }
  for (const angles& each : ignored_sectors) {
    require_finite(each);
    how.ignored.emplace_back(each.first, each.second);
  }
  for (const outline& each : masks) {
    if (each.size() < 3) raise_impossible("a mask has 3 corners or more", each.size());
    auto& corners = how.corners.emplace_back();
    for (const auto& [x_m, y_m] : each) {
      if (!std::isfinite(x_m) || !std::isfinite(y_m))
        raise_impossible("the corners of a mask are finite", std::pair(x_m, y_m));
      corners.push_back({x_m, y_m});
    }
  }
  how.masks.assign(how.corners.begin(), how.corners.end());
  how.made.ignored_sectors = how.ignored;
  how.made.masks = how.masks;
  how.made.least_range_mm = least_range_mm;
  how.made.greatest_range_mm = greatest_range_mm;
  how.made.returns_only = returns_only;
  how.made.trusted_only = trusted_only;
  how.made.excluded = static_cast<point_flags>(excluded);
  const elements<point> from(points);
  return make_array<point>(from.span().size(), [&](std::span<point> out) {
    return (for_grid ? filter_for_grid(from.span(), how.made, out)
                     : filter_points(from.span(), how.made, out))
        .size();
  });
}

/// A copy of the points that `mark` changes.
template <class Mark>
array<point> marked(const array<point>& points, const Mark& mark) {
  const elements<point> from(points);
  array<point> made = array_of(from.span());
  const buffer memory(made.object, true);
  mark(memory.as<point>());
  return made;
}

std::size_t checked_window(std::size_t window) {
  if (window < 1 || window > max_window) raise_impossible("window: 1 to 16", window);
  return window;
}

}  // namespace

void bind_filters(nb::module_& module) {
  const point_filter everything;
  module.def("filter_points", &select, "points"_a, nb::kw_only(), "field_of_view"_a = nb::none(),
             "ignored_sectors"_a = std::vector<angles>{}, "masks"_a = std::vector<outline>{},
             "least_range_mm"_a = everything.least_range_mm,
             "greatest_range_mm"_a = everything.greatest_range_mm, "returns_only"_a = false,
             "trusted_only"_a = false, "excluded"_a = 0, "frame"_a = frame::robot,
             "for_grid"_a = false,
             "The points that meet every condition. Sectors are pairs of degrees (from, to), in "
             "the sense in which the "
             "angles of `frame` grow: in 'robot', counter-clockwise from straight ahead. `masks`: "
             "polygons of corners "
             "(x, y) in metres in the frame 'robot', whose returns are left out. Ranges in "
             "millimetres, both limits "
             "included. `returns_only` leaves out points without return, `trusted_only` those "
             "below 100 mm, `excluded` "
             "those with one of these flags (PointFlag). `for_grid`: what is left out for its "
             "range, place or flag "
             "stays and is flagged too near, so that fill_grid() gives NaN and not inf.");
  const speckle_limits speckle;
  module.def(
      "mark_isolated",
      [](const array<point>& points, std::size_t window, std::size_t count, float near_m,
         float near_ratio, scan_ends ends) {
        require_numbers({near_m, near_ratio});
        const speckle_limits limits{checked_window(window), count, near_m, near_ratio};
        return marked(points, [&](std::span<point> all) { mark_isolated(all, limits, ends); });
      },
      "points"_a, nb::kw_only(), "window"_a = speckle.window, "count"_a = speckle.count,
      "near_m"_a = speckle.near_m, "near_ratio"_a = speckle.near_ratio,
      "ends"_a = scan_ends::joined,
      "A copy in which returns with fewer than `count` near returns among `window` (1 to 16) "
      "samples on each side are "
      "flagged PointFlag.ISOLATED. Near is up to `near_m` metres, or `near_ratio` of the range if "
      "that is more.");
  const edge_limits edges;
  module.def(
      "mark_veiling",
      [](const array<point>& points, std::size_t window, float least_angle_deg, scan_ends ends) {
        if (!(least_angle_deg > 0.0F && least_angle_deg <= 45.0F)) {
          raise_impossible("least_angle_deg: above 0, at most 45", least_angle_deg);
        }
        const edge_limits limits{checked_window(window), least_angle_deg};
        return marked(points, [&](std::span<point> all) { mark_veiling(all, limits, ends); });
      },
      "points"_a, nb::kw_only(), "window"_a = edges.window,
      "least_angle_deg"_a = edges.least_angle_deg, "ends"_a = scan_ends::joined,
      "A copy in which points between two surfaces, where nothing is, are flagged "
      "PointFlag.VEILING: the lines to "
      "neighbours on both sides make less than `least_angle_deg` degrees with the beam.");
  nb::class_<near_history>(module, "NearHistory",
                           "From which directions near returns came last, for mark_near(): one for "
                           "each lidar. One thread at a time.")
      .def(nb::init<>())
      .def("reset", &near_history::reset, "Forgets all returns.");
  const near_limits near;
  module.def(
      "mark_near",
      [](const array<point>& points, near_history& history, float shortest_mm,
         std::uint32_t revolutions) {
        if (!(shortest_mm > 0.0F)) throw nb::value_error("shortest_mm: above 0");
        const near_limits limits{shortest_mm, revolutions};
        return marked(points, [&](std::span<point> all) { mark_near(all, history, limits); });
      },
      "points"_a, "history"_a, nb::kw_only(), "shortest_mm"_a = near.shortest_mm,
      "revolutions"_a = near.revolutions,
      "A copy in which points without return are flagged PointFlag.MAY_BE_TOO_NEAR if, in the last "
      "`revolutions`, a return came from their direction from less than twice `shortest_mm` (280 "
      "at 9 kHz, 260 at 8, 100 at 4), and none that is farther since. `revolutions` 0: until a "
      "return comes. `points`: all points of a lidar in their order, scan by scan, before they are "
      "filtered or deskewed. fill_grid() gives NaN there, or -inf with `near_is_minus_infinity`. "
      "It misses some targets, and has false alarms: too_near.hpp has their numbers.");
  module.def(
      "mark_bit_errors",
      [](const array<point>& points) {
        return marked(points, [](std::span<point> all) { mark_bit_errors(all); });
      },
      "points"_a,
      "A copy in which returns that differ in one bit of the raw sample from a smooth surface are "
      "flagged "
      "PointFlag.UNLIKELY.");
}

}  // namespace g4lidar::python
