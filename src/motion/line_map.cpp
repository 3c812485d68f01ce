// SPDX-License-Identifier: MIT
#include "motion/line_map.hpp"

#include <algorithm>
#include <cmath>

#include "motion/symmetric_3.hpp"

namespace g4lidar {
namespace {

constexpr std::size_t fewest_points = 5;
/// The variance of the direction of a line without noise: the angles of a packet are rounded, all in the same way.
constexpr double rounding_rad2 = 1e-6;

/// Without the care of std::hypot for values that are too large to square, and four times as fast.
double length_of(double x, double y) noexcept { return std::sqrt(x * x + y * y); }

double squared_distance(const positions& p, std::size_t a, std::size_t b) noexcept {
  return squared(p.x[a] - p.x[b]) + squared(p.y[a] - p.y[b]);
}

/// A number in [0, 4) that grows with the direction from the origin, without an arctangent.
double turn_of(double x, double y) noexcept {
  const double size = std::abs(x) + std::abs(y);
  if (size == 0.0) return 0.0;
  const double part = y / size;
  const double turn = x < 0.0 ? 2.0 - part : part < 0.0 ? 4.0 + part : part;
  return turn < 4.0 ? turn : 0.0;
}

}  // namespace

void line_map::build(const positions& points, std::size_t count) noexcept {
  add_up(points, count);
  std::size_t from = 0;
  std::size_t to = 0;  // the last one of the window
  for (std::size_t i = 0; i < count; ++i) {
    const double range = length_of(points.x[i], points.y[i]);
    const double half_length2 = squared(0.12 + 0.015 * range);
    to = std::max(to, i);
    while (piece_[from] != piece_[i] || squared_distance(points, from, i) > half_length2) ++from;
    while (to + 1 < count && piece_[to + 1] == piece_[i] &&
           squared_distance(points, to + 1, i) <= half_length2)
      ++to;
    has_line_[i] = fit(from, to + 1, range, lines_[i]);
  }
  sort(points, count);
}

void line_map::add_up(const positions& points, std::size_t count) noexcept {
  sums sum{};
  std::uint32_t piece = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = points.x[i];
    const double y = points.y[i];
    // On a surface that the ray meets at 4 degrees or more, neighbours are nearer to each other than this.
    if (i > 0 && squared_distance(points, i - 1, i) > squared(0.03 + 0.06 * length_of(x, y)))
      ++piece;
    piece_[i] = piece;
    sums_[i] = sum;
    sum = {sum.x + x, sum.y + y, sum.xx + x * x, sum.xy + x * y, sum.yy + y * y};
  }
  sums_[count] = sum;
}

bool line_map::fit(std::size_t from, std::size_t to, double range,
                   fitted_line& out) const noexcept {
  const std::size_t count = to - from;
  if (count < fewest_points) return false;
  const auto n = static_cast<double>(count);
  const sums& a = sums_[from];
  const sums& b = sums_[to];
  out.x = (b.x - a.x) / n;
  out.y = (b.y - a.y) / n;
  const double xx = (b.xx - a.xx) / n - out.x * out.x;
  const double xy = (b.xy - a.xy) / n - out.x * out.y;
  const double yy = (b.yy - a.yy) / n - out.y * out.y;
  const double middle = 0.5 * (xx + yy);
  const double spread = length_of(0.5 * (xx - yy), xy);
  const double along = middle + spread;
  const double across = std::max(middle - spread, 1e-8);
  // Not a line: thicker than the noise of a G4, or as thick as long.
  if (across > squared(0.015 + 0.004 * range) || along < 12.0 * across) return false;
  // The tangent is the longer one of two forms of the eigenvector.
  const double tangent_x = xx > yy ? along - yy : xy;
  const double tangent_y = xx > yy ? xy : along - xx;
  const double length = length_of(tangent_x, tangent_y);
  if (!(length > 0.0)) return false;
  out.normal_x = -tangent_y / length;
  out.normal_y = tangent_x / length;
  out.normal_variance = across / (along * (n - 2.0)) + rounding_rad2;
  out.variance = across;
  return true;
}

void line_map::sort(const positions& points, std::size_t count) noexcept {
  first_.fill(0);
  size_ = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!has_line_[i]) continue;
    direction_[i] =
        static_cast<std::uint32_t>(turn_of(points.x[i], points.y[i]) * (directions / 4.0));
    ++first_[direction_[i] + 1];
    ++size_;
  }
  for (std::size_t d = 0; d < directions; ++d) first_[d + 1] += first_[d];
  // Filled from the back, first_[d + 1] becomes the begin of direction d: shifted afterwards.
  for (std::size_t i = count; i-- > 0;) {
    if (!has_line_[i]) continue;
    entries_[--first_[direction_[i] + 1]] = {points.x[i], points.y[i],
                                             static_cast<std::uint32_t>(i)};
  }
  std::copy(first_.begin() + 1, first_.end(), first_.begin());
  first_[directions] = static_cast<std::uint32_t>(size_);
}

line_map::sector line_map::sector_at(double x, double y) noexcept {
  constexpr std::size_t width = 4;  // directions to each side: 1.3 to 2.5 degrees
  const auto middle = static_cast<std::size_t>(turn_of(x, y) * (directions / 4.0));
  const std::size_t to = middle + width + 1;
  if (middle < width) return {{middle + directions - width, 0}, {directions, to}};
  if (to > directions) return {{middle - width, 0}, {directions, to - directions}};
  return {{middle - width, 0}, {to, 0}};
}

bool line_map::has_direction(double x, double y) const noexcept {
  const sector s = sector_at(x, y);
  return first_[s.to[0]] > first_[s.from[0]] || first_[s.to[1]] > first_[s.from[1]];
}

std::size_t line_map::nearest(double x, double y, double reach_m) const noexcept {
  const sector s = sector_at(x, y);
  double best = reach_m * reach_m;
  std::size_t found = none;
  for (std::size_t part = 0; part < 2; ++part) {
    for (std::size_t k = first_[s.from[part]]; k < first_[s.to[part]]; ++k) {
      const double distance = squared(entries_[k].x - x) + squared(entries_[k].y - y);
      if (distance >= best) continue;
      best = distance;
      found = entries_[k].index;
    }
  }
  return found;
}

}  // namespace g4lidar
