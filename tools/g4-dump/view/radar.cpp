// SPDX-License-Identifier: MIT
#include "radar.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "g4lidar/cartesian.hpp"

namespace g4_tool {
namespace {

using g4lidar::point;

/// The zoom ranges in metres.
constexpr std::array<double, 12> ranges{0.5, 1.0,  2.0,  3.0,  4.0,  6.0,
                                        8.0, 12.0, 16.0, 24.0, 32.0, 50.0};
/// The distance between the rings of each.
constexpr std::array<double, 12> steps{0.25, 0.5, 0.5, 1.0, 1.0, 2.0,
                                       2.0,  4.0, 4.0, 8.0, 8.0, 10.0};
/// The range without any return.
constexpr double usual_range_m = 16.0;
/// The share of the returns that range_for() shows.
constexpr double nearly_all = 0.97;

std::size_t level_of(double range_m) noexcept {
  const auto at = std::ranges::lower_bound(ranges, range_m - 1e-9);
  return std::min<std::size_t>(static_cast<std::size_t>(at - ranges.begin()), ranges.size() - 1);
}

/// The middle of an area and the number of dots per metre.
struct scale {
  double x;
  double y;
  double dots_per_m;
  int begin_x, begin_y, end_x, end_y;

  scale(const canvas& canvas, const cell_area& area, double range_m)
      : begin_x(area.column * canvas.dots_across()),
        begin_y(area.row * canvas.dots_down()),
        end_x((area.column + area.columns) * canvas.dots_across()),
        end_y((area.row + area.rows) * canvas.dots_down()) {
    x = (begin_x + end_x - 1) / 2.0;
    y = (begin_y + end_y - 1) / 2.0;
    const double radius = (std::min(end_x - begin_x, end_y - begin_y) - 1) / 2.0;
    dots_per_m = radius / range_m;
  }
  /// The dots of the robot.
  [[nodiscard]] int column_of(const radar_view& view) const {
    return static_cast<int>(x - view.robot.y_m * dots_per_m);
  }
  [[nodiscard]] int row_of(const radar_view& view) const {
    return static_cast<int>(y - view.robot.x_m * dots_per_m);
  }
  void dot(canvas& canvas, double right_m, double up_m, ink ink) const {
    const double at_x = x + right_m * dots_per_m;
    const double at_y = y - up_m * dots_per_m;
    const int column = static_cast<int>(std::lround(at_x));
    const int row = static_cast<int>(std::lround(at_y));
    if (column < begin_x || column >= end_x || row < begin_y || row >= end_y) return;
    canvas.dot(column, row, ink);
  }
};

void draw_grid(canvas& canvas, const cell_area& area, const scale& to, const radar_view& view) {
  const double step_m = steps[level_of(view.range_m)];
  const int rings = static_cast<int>(view.range_m / step_m + 1e-9);
  for (int ring = 1; ring <= rings; ++ring) {
    const double ring_m = ring * step_m;
    const double radius = ring_m * to.dots_per_m;
    const int dots = 4 * std::max(2, static_cast<int>(radius / 2.0));  // about every third one
    for (int i = 0; i < dots; ++i) {
      const double turn = 2.0 * std::numbers::pi * i / dots;
      to.dot(canvas, ring_m * std::sin(turn) - view.robot.y_m,
             ring_m * std::cos(turn) + view.robot.x_m, ink::grid);
    }
    const double top = to.y - view.robot.x_m * to.dots_per_m - radius;
    const int row = static_cast<int>(std::lround(top)) / canvas.dots_down();
    const int column = to.column_of(view) / canvas.dots_across() + 1;
    if (row >= area.row) canvas.write(column, row, fmt::format("{:g} m", ring_m), ink::faint, area);
  }
}

}  // namespace

double next_range(double range_m, bool farther) noexcept {
  const std::size_t level = level_of(range_m);
  if (farther) return ranges[std::min(level + 1, ranges.size() - 1)];
  return ranges[level == 0 ? 0 : level - 1];
}

double range_for(std::span<const point> points) noexcept {
  std::array<std::size_t, ranges.size()> counts{};
  std::size_t all = 0;
  for (const point& each : points) {
    if (each.is_no_return()) continue;
    ++counts[level_of(static_cast<double>(each.range_mm) / 1000.0)];
    ++all;
  }
  if (all == 0) return usual_range_m;
  std::size_t seen = 0;
  for (std::size_t level = 0; level < ranges.size(); ++level) {
    seen += counts[level];
    if (static_cast<double>(seen) >= nearly_all * static_cast<double>(all)) return ranges[level];
  }
  return ranges.back();
}

void draw_radar(canvas& canvas, const cell_area& area, std::span<const point> points,
                const radar_view& view) {
  if (area.columns < 3 || area.rows < 2) return;
  const scale to(canvas, area, view.range_m);
  if (view.grid) draw_grid(canvas, area, to, view);
  const bool is_robot = view.frame == g4lidar::frame::robot;
  for (const g4lidar::xy_point& at : view.traces)
    to.dot(canvas, -static_cast<double>(at.y_m), static_cast<double>(at.x_m), ink::grid);
  const g4lidar::rotation turned = g4lidar::rotation_by(view.robot.yaw_rad);
  for (const point& each : points) {
    if (each.is_no_return()) continue;
    const g4lidar::xy_point at = g4lidar::to_xy(each, view.frame, view.turn_deg);
    const auto ahead_m = static_cast<double>(at.x_m);
    const auto side_m = static_cast<double>(at.y_m);  // to the left in the robot frame only
    const double left_m =
        view.robot.y_m + turned.sine * ahead_m + turned.cosine * (is_robot ? side_m : -side_m);
    const double up_m =
        view.robot.x_m + turned.cosine * ahead_m - turned.sine * (is_robot ? side_m : -side_m);
    to.dot(canvas, -left_m, up_m, ink::points);
  }
  const int row = to.row_of(view);
  if (row >= 0)
    canvas.write(to.column_of(view) / canvas.dots_across(), row / canvas.dots_down(), "+",
                 ink::title, area);
  if (!view.grid) return;
  const char* const up = view.is_map ? "x" : is_robot ? "^" : "0";
  canvas.write(static_cast<int>(to.x) / canvas.dots_across(), area.row, up, ink::title, area);
}

}  // namespace g4_tool
