// SPDX-License-Identifier: MIT
// Coordinates, grids, deskewing and merging of arrays of points.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <cmath>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <variant>
#include <vector>

#include "enumeration_words.hpp"
#include "errors.hpp"
#include "g4lidar/merge.hpp"
#include "g4lidar/motion/deskew.hpp"
#include "g4lidar/motion/twist_estimator.hpp"
#include "kept_scan.hpp"

namespace g4lidar::python {
namespace {

using namespace nb::literals;

/// A constant twist, or poses with times.
using motion = std::variant<twist_2d, array<stamped_pose>>;
/// Points, how the lidar is mounted, and its turn or its model.
using merged_lidar =
    std::variant<std::pair<array<point>, mounting>, std::tuple<array<point>, mounting, unsigned>,
                 std::tuple<array<point>, mounting, std::string>>;

/// The turn of a lidar whose points do not state it: `turn_deg`, else that of the model. Raises ValueError if
/// it is the turn of no model, or not that of the given one.
std::uint16_t turn_of(const std::optional<unsigned>& turn_deg, const model& model, bool is_named) {
  if (!turn_deg) return model.turn_deg;
  if (*turn_deg != 0 && *turn_deg != 180) raise_impossible("turn_deg: 0 or 180", *turn_deg);
  if (is_named && *turn_deg != model.turn_deg) {
    raise_impossible("turn_deg of the model: " + std::to_string(model.turn_deg), *turn_deg);
  }
  return static_cast<std::uint16_t>(*turn_deg);
}
std::uint16_t turn_of(const std::optional<unsigned>& turn_deg,
                      const std::optional<std::string>& word) {
  return turn_of(turn_deg, model_or_g4(word), word.has_value());
}

void require_finite(std::initializer_list<double> values) {
  for (const double value : values) {
    if (!(std::abs(value) <= max_odometry_value))
      raise_impossible("numbers are finite, and at most 1e6", value);
  }
}

/// `make(motion)` with the twist, or with the poses.
template <class Make>
auto with_motion(const motion& motion, const Make& make) {
  if (const auto* twist = std::get_if<twist_2d>(&motion)) {
    require_finite({twist->x_m_per_s, twist->y_m_per_s, twist->yaw_rad_per_s});
    return make(*twist);
  }
  const elements<stamped_pose> path(std::get<array<stamped_pose>>(motion));
  require_path(path.span());
  return make(path.span());
}

std::tuple<array<point>, std::size_t> deskew_array(const array<point>& points, const motion& motion,
                                                   std::int64_t reference_ns, const mounting& mount,
                                                   const std::optional<unsigned>& turn_deg,
                                                   const std::optional<std::string>& model) {
  const std::uint16_t turn = turn_of(turn_deg, model);
  const elements<point> from(points);
  std::size_t outside = 0;
  auto made = make_array<point>(from.span().size(), [&](std::span<point> out) {
    outside = with_motion(motion, [&](const auto& moved) {
      return deskew(from.span(), moved, reference_ns, out, mount, turn).outside;
    });
  });
  return {std::move(made), outside};
}

std::tuple<array<point>, std::size_t, std::vector<bool>> merge_arrays(
    const std::vector<merged_lidar>& lidars, const motion& motion, std::int64_t reference_ns,
    double fresh) {
  if (lidars.size() > 32) raise_impossible("at most 32 lidars", lidars.size());
  if (!(fresh >= 0.0 && fresh <= 3600.0)) raise_impossible("fresh: 0 to 3600 seconds", fresh);
  std::deque<elements<point>> kept;
  std::vector<mounted_scan> scans;
  std::size_t count = 0;
  const auto add = [&](const array<point>& points, const mounting& mount, std::uint16_t turn_deg) {
    scans.push_back({kept.emplace_back(points).span(), mount, turn_deg});
    count += scans.back().points.size();
  };
  for (const merged_lidar& each : lidars) {
    if (const auto* with_turn = std::get_if<1>(&each)) {
      const auto& [points, mount, turn_deg] = *with_turn;
      add(points, mount, turn_of(turn_deg, std::nullopt));
    } else if (const auto* with_model = std::get_if<2>(&each)) {
      const auto& [points, mount, word] = *with_model;
      add(points, mount, model_or_g4(word).turn_deg);
    } else {
      const auto& [points, mount] = std::get<0>(each);
      add(points, mount, g4_model.turn_deg);
    }
  }
  merged result;
  auto made = make_array<point>(count, [&](std::span<point> out) {
    result = with_motion(motion, [&](const auto& moved) {
      return merge_scans(scans, moved, reference_ns, out, static_cast<std::int64_t>(fresh * 1e9));
    });
    return result.points.size();
  });
  std::vector<bool> lost;
  for (std::size_t i = 0; i < lidars.size(); ++i) lost.push_back(result.is_lost(i));
  return {std::move(made), result.outside, std::move(lost)};
}

std::string_view name_of(twist_status status) {
  constexpr std::array<std::string_view, 7> names{
      "known",           "degenerate",      "first_scan",       "no_times",
      "too_few_returns", "lost_revolution", "no_correspondence"};
  return names[static_cast<std::size_t>(status)];
}

void bind_motion(nb::module_& module) {
  nb::class_<twist_2d>(module, "Twist",
                       "A velocity in the moving frame of a robot: x ahead, y to the left.")
      .def(nb::init<double, double, double>(), "x_m_per_s"_a = 0.0, "y_m_per_s"_a = 0.0,
           "yaw_rad_per_s"_a = 0.0, "Metres per second, and radians per second counter-clockwise.")
      .def_rw("x_m_per_s", &twist_2d::x_m_per_s, "Ahead, in metres per second.")
      .def_rw("y_m_per_s", &twist_2d::y_m_per_s, "To the left, in metres per second.")
      .def_rw("yaw_rad_per_s", &twist_2d::yaw_rad_per_s,
              "Counter-clockwise, in radians per second.");
  nb::class_<mounting>(module, "Mounting", "How a lidar is fixed to a robot.")
      .def(
          "__init__",
          [](mounting* made, double x_m, double y_m, double yaw_rad, bool upside_down) {
            require_finite({x_m, y_m, yaw_rad});
            new (made) mounting{{x_m, y_m, yaw_rad}, upside_down};
          },
          "x_m"_a = 0.0, "y_m"_a = 0.0, "yaw_rad"_a = 0.0, "upside_down"_a = false,
          "The place of the lidar's own frame ('robot') in the frame of the robot, in metres and "
          "radians "
          "counter-clockwise, and whether the lidar hangs with its top down.")
      .def_prop_ro(
          "x_m", [](const mounting& m) { return m.pose.x_m; },
          "Ahead of the robot's origin, in metres.")
      .def_prop_ro(
          "y_m", [](const mounting& m) { return m.pose.y_m; }, "To its left, in metres.")
      .def_prop_ro(
          "yaw_rad", [](const mounting& m) { return m.pose.yaw_rad; },
          "Counter-clockwise, in radians.")
      .def_ro("upside_down", &mounting::upside_down, "Whether the lidar hangs with its top down.");
}

void bind_estimator(nb::module_& module) {
  nb::class_<twist_estimate>(module, "TwistEstimate",
                             "The motion of a lidar during two revolutions.")
      .def_ro("twist", &twist_estimate::twist, "The twist of the lidar's own frame ('robot').")
      .def_ro("covariance", &twist_estimate::covariance,
              "The covariance of x, y and yaw, row by row, in (m/s)^2, m rad/s^2 and (rad/s)^2.")
      .def_ro("known", &twist_estimate::known,
              "Whether x, y and yaw are known. In a corridor the speed along it is not.")
      .def_prop_ro(
          "status", [](const twist_estimate& e) { return name_of(e.status); },
          "'known', 'degenerate' (in some directions only), or why it was not estimated: "
          "'first_scan', "
          "'no_times', 'too_few_returns', 'lost_revolution', 'no_correspondence'.")
      .def_prop_ro("is_known", &twist_estimate::is_known, "Whether all of the twist is known.");
  nb::class_<twist_estimator>(
      module, "TwistEstimator",
      "Estimates the motion of a lidar from its scans alone. One thread at a time.")
      .def(nb::init<>())
      .def(
          "add",
          [](twist_estimator& estimator, const array<point>& points,
             const std::optional<unsigned>& turn_deg, const std::optional<std::string>& model) {
            return estimator.add(elements<point>(points).span(), turn_of(turn_deg, model),
                                 model_or_g4(model).range.min_mm);
          },
          "points"_a, "turn_deg"_a = nb::none(), nb::kw_only(), "model"_a = nb::none(),
          "The twist during the revolution before `points` and `points`, those of the next "
          "revolution. `model`: Scan.model; None: a G4, whose turn is 180 and whose shortest range "
          "is 100 mm. "
          "`turn_deg`: Scan.turn_deg, without `model`.")
      .def("reset", &twist_estimator::reset, "Forgets all scans.");
}

}  // namespace

void require_path(std::span<const stamped_pose> path) {
  for (std::size_t i = 0; i < path.size(); ++i) {
    require_finite({path[i].pose.x_m, path[i].pose.y_m, path[i].pose.yaw_rad});
    if (i > 0 && path[i].time_ns < path[i - 1].time_ns)
      throw nb::value_error("the times of the poses do not ascend");
  }
}

void bind_shaping(nb::module_& module) {
  bind_motion(module);
  bind_estimator(module);
  module.def(
      "to_xy",
      [](const array<point>& points, frame to, const std::optional<unsigned>& turn_deg,
         const std::optional<std::string>& model) {
        return to_xy_array(points, to, turn_of(turn_deg, model));
      },
      "points"_a, "frame"_a = frame::robot, "turn_deg"_a = nb::none(), nb::kw_only(),
      "model"_a = nb::none(),
      "x and y of each point in metres: see Scan.xy(). `model`: Scan.model; None: a G4, whose turn "
      "is 180. "
      "`turn_deg`: Scan.turn_deg, without `model`.");
  module.def(
      "fill_grid",
      [](const array<point>& points, std::optional<std::size_t> n, frame to, grid_pick pick,
         bool keep_too_near, no_return_as no_return, bool near_is_minus_infinity,
         const std::optional<unsigned>& turn_deg, std::optional<float> longest_mm,
         const std::optional<std::string>& word) {
        const model& which = model_or_g4(word);
        return to_ranges(points, n.value_or(default_bins(which)),
                         {to, pick, keep_too_near, no_return, near_is_minus_infinity,
                          turn_of(turn_deg, word), longest_mm.value_or(which.range.max_mm)});
      },
      "points"_a, "n"_a = nb::none(), "frame"_a = frame::robot, "pick"_a = grid_pick::nearest,
      "keep_too_near"_a = false, "no_return"_a = no_return_as::infinity,
      "near_is_minus_infinity"_a = false, "turn_deg"_a = nb::none(), "longest_mm"_a = nb::none(),
      nb::kw_only(), "model"_a = nb::none(),
      "The points on a grid of `n` directions, in metres: see Scan.ranges(). `model`: Scan.model; "
      "None: a G4, with 720 directions, a turn of 180 and 16000 mm. `turn_deg`: Scan.turn_deg, "
      "without "
      "`model`. `longest_mm`: what 'max' is, in millimetres; None: by the model.");
  module.def(
      "deskew", &deskew_array, "points"_a, "motion"_a, "reference_ns"_a, "mount"_a = mounting{},
      "turn_deg"_a = nb::none(), nb::kw_only(), "model"_a = nb::none(),
      "The points as seen from where the lidar was at `reference_ns` (nanoseconds of the "
      "monotonic clock), while the "
      "robot moved with a constant Twist, or along poses (an array with the dtype "
      "POSE_DTYPE, times ascending). "
      "Returns new points, and how many of them were left where they were and flagged "
      "PointFlag.NOT_DESKEWED, because "
      "their time or the motion is not known. `model`: Scan.model; None: a G4, whose turn is "
      "180. `turn_deg`: Scan.turn_deg, without `model`.");
  module.def(
      "merge_scans", &merge_arrays, "lidars"_a, "motion"_a, "reference_ns"_a,
      "fresh"_a = static_cast<double>(fresh_scan_ns) * 1e-9,
      "The points of up to 32 lidars, each with its Mounting, and its Scan.model or "
      "Scan.turn_deg if it is not a G4, as those of one G4 at the robot's origin, deskewed to "
      "`reference_ns`. Returns the points; how many were not deskewed; and for each lidar "
      "whether it is lost: without "
      "points, or with a last point farther than `fresh` seconds from `reference_ns`.");
}

}  // namespace g4lidar::python
