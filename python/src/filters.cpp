// SPDX-License-Identifier: MIT
// Shaping scans, and marking the points of an array.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "enumeration_words.hpp"
#include "errors.hpp"
#include "g4lidar/filter/outliers.hpp"
#include "g4lidar/filter/plausibility.hpp"
#include "g4lidar/options/filter_text.hpp"
#include "g4lidar/scan_shaper.hpp"
#include "kept_scan.hpp"

namespace g4lidar::python {
namespace {

using namespace nb::literals;
using angles = std::pair<double, double>;
using outline = std::vector<std::pair<float, float>>;

void require_numbers(std::initializer_list<double> values) {
  for (const double value : values) {
    if (std::isnan(value)) throw nb::value_error("a limit is a number, not NaN");
  }
}

void require_finite(const angles& sector) {
  if (!std::isfinite(sector.first) || !std::isfinite(sector.second))
    raise_impossible("the angles of a sector are finite", sector);
}

/// A scan_shaper with the memory of the scan that it shapes.
class shaper {
 public:
  explicit shaper(const shaping_options& how) : made_(how) {}

  void shape(scan source, const array<point>& points,
             const std::optional<array<stamped_pose>>& path) {
    source.points = points_.emplace(points).span();
    path_.reset();
    if (path) require_path(path_.emplace(*path).span());
    made_.shape(source, path_ ? path_->span() : std::span<const stamped_pose>());
  }
  [[nodiscard]] scan_shaper& made() noexcept { return made_; }

 private:
  std::optional<elements<point>> points_;
  std::optional<elements<stamped_pose>> path_;
  scan_shaper made_;
};

void make_shaper(shaper* made, const std::optional<angles>& field_of_view,
                 const std::vector<angles>& ignored_sectors, const std::vector<outline>& masks,
                 float least_range_mm, float greatest_range_mm, bool returns_only,
                 bool trusted_only, unsigned excluded, frame in, bool speckle, bool edges,
                 bool near, float shortest_mm, std::uint32_t near_revolutions, deskewing deskew,
                 const mounting& mount, bool restamps, bool for_merging) {
  require_numbers({least_range_mm, greatest_range_mm});
  if (excluded > 0xFFU) raise_impossible("excluded: flags of PointFlag", excluded);
  if (!(shortest_mm >= 0.0F)) throw nb::value_error("shortest_mm: not below 0");
  shaping_options how{.filter = {.in = in,
                                 .least_range_mm = least_range_mm,
                                 .greatest_range_mm = greatest_range_mm,
                                 .returns_only = returns_only,
                                 .trusted_only = trusted_only,
                                 .excluded = static_cast<point_flags>(excluded)},
                      .deskew = deskew,
                      .mount = mount,
                      .restamps = restamps,
                      .for_merging = for_merging};
  if (speckle) how.marks.speckle.emplace();
  if (edges) how.marks.edges.emplace();
  if (near) how.marks.near = near_limits{shortest_mm, near_revolutions};
  if (field_of_view) {
    require_finite(*field_of_view);
    how.filter.field_of_view = sector(field_of_view->first, field_of_view->second);
  }
  std::vector<sector> ignored;
  for (const angles& each : ignored_sectors) {
    require_finite(each);
    ignored.emplace_back(each.first, each.second);
  }
  mask outlines;
  for (const outline& each : masks) {
    if (each.size() < 3) raise_impossible("a mask has 3 corners or more", each.size());
    std::vector<corner> corners;
    for (const auto& [x_m, y_m] : each) {
      if (!std::isfinite(x_m) || !std::isfinite(y_m))
        raise_impossible("the corners of a mask are finite", std::pair(x_m, y_m));
      corners.push_back({x_m, y_m});
    }
    outlines.add(std::move(corners));
  }
  how.filter.ignored_sectors = ignored;
  how.filter.masks = outlines.polygons();
  new (made) shaper(how);
}

void bind_shaping_of(nb::class_<shaper>& made) {
  made.def(
          "shape",
          [](shaper& self, const kept_scan& scan, const std::optional<array<stamped_pose>>& path) {
            self.shape(scan.about, scan.points, path);
            return nb::find(self);
          },
          "scan"_a, "path"_a = nb::none(), nb::rv_policy::reference,
          nb::sig("def shape(self, scan: Scan, path: numpy.typing.NDArray[numpy.void] | None = "
                  "None) -> ScanShaper"),
          "Takes the next scan, in order, and for 'by_path' poses (an array with the dtype "
          "POSE_DTYPE, times ascending). Call it for each scan. Returns the shaper.")
      .def(
          "shape",
          [](shaper& self, const array<point>& points,
             const std::optional<array<stamped_pose>>& path,
             const std::optional<std::string>& model) {
            scan whole;
            whole.model = &model_or_g4(model);
            self.shape(whole, points, path);
            return nb::find(self);
          },
          "scan"_a, "path"_a = nb::none(), nb::kw_only(), "model"_a = nb::none(),
          nb::sig("def shape(self, scan: numpy.typing.NDArray[numpy.void], path: "
                  "numpy.typing.NDArray[numpy.void] | None = None, *, model: str | None = None) -> "
                  "ScanShaper"),
          "The same with the points of a whole revolution. `model`: Scan.model; None: a G4.")
      .def_prop_ro(
          "kept", [](shaper& self) { return array_of(self.made().kept().points); },
          "The points that are kept, as a new array. The points and poses that were given must not "
          "have changed.")
      .def_prop_ro(
          "for_grid", [](shaper& self) { return array_of(self.made().for_grid().points); },
          "The same for fill_grid(): what is left out for its range, place or flag stays and is "
          "flagged too near, so that fill_grid() gives NaN and not inf.")
      .def_prop_ro(
          "twist", [](shaper& self) { return self.made().twist(); },
          "The Twist of the lidar by 'by_scans'; None if it is not known.")
      .def_prop_ro(
          "outside", [](shaper& self) { return self.made().outside(); },
          "How many points of the scan, kept or not, have no known motion.")
      .def_prop_ro(
          "points_not_deskewed", [](shaper& self) { return self.made().points_not_deskewed(); },
          "The sum of `outside` over all scans.");
}

void bind_shaper(nb::module_& module) {
  const point_filter everything;
  const near_limits near;
  nb::class_<shaper> made(
      module, "ScanShaper",
      "Marks, filters and deskews the scans of one lidar. One thread at a time.");
  made.def(
      "__init__", &make_shaper, nb::kw_only(), "field_of_view"_a = nb::none(),
      "ignored_sectors"_a = std::vector<angles>{}, "masks"_a = std::vector<outline>{},
      "least_range_mm"_a = everything.least_range_mm,
      "greatest_range_mm"_a = everything.greatest_range_mm, "returns_only"_a = false,
      "trusted_only"_a = false, "excluded"_a = 0, "frame"_a = frame::robot, "speckle"_a = false,
      "edges"_a = false, "near"_a = false, "shortest_mm"_a = near.shortest_mm,
      "near_revolutions"_a = near.revolutions, "deskew"_a = deskewing::none, "mount"_a = mounting{},
      "restamps"_a = false, "for_merging"_a = false,
      "Points are kept that meet every condition. Sectors are pairs of degrees (from, to), in "
      "the sense in which the angles of `frame` grow: in 'robot', counter-clockwise from "
      "straight ahead. `masks`: polygons of corners (x, y) in metres in the frame 'robot', "
      "whose returns are left out. Ranges in millimetres, both limits included. "
      "`returns_only` leaves out points without return, `trusted_only` those that are too "
      "near, "
      "`excluded` those with one of these flags (PointFlag). `speckle` and `edges` leave out "
      "what mark_isolated() and mark_veiling() flag. `near` flags points without return as "
      "PointFlag.MAY_BE_TOO_NEAR if, in the last `near_revolutions` (0: until a return "
      "comes), a return came from their direction from less than twice `shortest_mm` (0: by "
      "the model; 280 of a G4 at "
      "9 kHz, 260 at 8, 100 at 4), and none that is farther since; filter/too_near.hpp has the "
      "numbers of what it misses and of false alarms. `deskew`: 'by_path' moves points to "
      "where they would have been seen at the time of the first one, by the poses of the "
      "robot on which the lidar has the pose `mount`; 'by_scans' by a TwistEstimator. "
      "Points whose motion is not known stay, flagged PointFlag.NOT_DESKEWED. `restamps` "
      "gives the others the time of the first one. `for_merging`: only the twist is "
      "estimated, because merge_scans() deskews.");
  bind_shaping_of(made);
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
  bind_shaper(module);
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
      "that is more (negative: 0.05, and more if the samples are more than 0.28 degrees apart).");
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
  module.def(
      "mark_bit_errors",
      [](const array<point>& points, const std::optional<std::string>& word) {
        const model& which = model_or_g4(word);
        return marked(
            points, [&](std::span<point> all) { mark_bit_errors(all, {}, which.samples.layout); });
      },
      "points"_a, nb::kw_only(), "model"_a = nb::none(),
      "A copy in which returns that differ in one bit of the raw sample from a smooth surface are "
      "flagged "
      "PointFlag.UNLIKELY. `model`: Scan.model; None: a G4, whose raw samples are quarters of a "
      "millimetre.");
}

}  // namespace g4lidar::python
