// SPDX-License-Identifier: MIT
// Where a curved beam hits straight walls. With q(d) = tan(correction(d)) = k/d - c, the point of
// the beam at the first-level angle theta and range d is
//     P(d) = (d e + (k - c d) n) / g(d),   g(d) = sqrt(1 + q(d)^2),
// e pointing towards theta and n 90 degrees further. It is on the line N.P = h of a wall where
//     f(d) = d N.e + (k - c d) N.n - h g(d) = 0.
// Without g that is a straight line: the laser beam beside the centre. g is convex up to the range
// at which its curvature changes its sign, and concave from there on, and f likewise. So there are
// at most two roots in either part, and a reliable way to find all of them without a trigonometric
// function.
#include "exact.hpp"

#include "g4lidar/detail/sim/ray_caster.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "g4lidar/core/angle.hpp"
#include "g4lidar/detail/sim/arithmetic.hpp"

namespace g4lidar::sim {
namespace {

constexpr double k = 21.8;           // mm, the laser's offset
constexpr double c = 21.8 / 155.3;   // its slope: it crosses the centre line at 155.3 mm
constexpr double least_range = 1.0;  // mm
constexpr double inflection = 232.7808551523369427;  // mm; 0 = 3k - 2cd + 2(k - cd) q^2
constexpr double slack = 1e-6;  // mm; walls are extended by it, so that corners are closed

constexpr std::size_t sectors = 720;

double squared(double x) noexcept { return x * x; }

// f of the comment at the top, for one wall and one beam.
struct gap {
  double slope;   // N.e - c N.n
  double offset;  // k N.n
  double h;

  struct value {
    double f;
    double slope;
  };

  [[nodiscard]] value at(double d) const noexcept {
    const double k_by_d = k / d;
    const double q = k_by_d - c;
    const double g = std::sqrt(1.0 + q * q);
    return {slope * d + offset - h * g, slope + h * q * k_by_d / (d * g)};
  }
};

struct end {
  double d;
  gap::value v;
};

// The root between two ends of different sign: Newton steps, or bisection where these leave the
// interval.
double root_between(const gap& f, end low, end high) noexcept {
  const bool rising = low.v.f < 0.0;
  double a = low.d;
  double b = high.d;
  double d = a + (b - a) * (low.v.f / (low.v.f - high.v.f));
  for (int i = 0; i < 100; ++i) {
    if (!(d > a && d < b)) d = 0.5 * (a + b);
    const gap::value v = f.at(d);
    if ((v.f < 0.0) == rising) {
      a = d;
    } else {
      b = d;
    }
    const double step = v.slope != 0.0 ? -v.f / v.slope : b - a;
    const double next = d + step;
    const bool arrived = std::fabs(step) <= 1e-10 || b - a <= 1e-10;
    if (arrived) return next >= a && next <= b ? next : d;
    d = next;
  }
  return d;
}

struct roots {
  std::array<double, 2> at{};
  std::size_t count = 0;
};

// All roots between two ends, where f is convex or concave.
roots roots_between(const gap& f, end low, end high) noexcept {
  if ((low.v.f < 0.0) != (high.v.f < 0.0)) return {{root_between(f, low, high)}, 1};
  // Both ends have the same sign. Two roots are possible only if f approaches zero between them:
  // search for a point with the other sign. The tangents at the ends bound f; their intersection is
  // tried next.
  const double side = low.v.f < 0.0 ? -1.0 : 1.0;
  end a = low;
  end b = high;
  for (int i = 0; i < 60; ++i) {
    if (a.v.slope * side >= 0.0 || b.v.slope * side <= 0.0) return {};
    const double reach = (b.v.f - a.v.f - b.v.slope * (b.d - a.d)) / (a.v.slope - b.v.slope);
    if ((a.v.f + a.v.slope * reach) * side > 0.0) return {};  // f does not reach zero
    const double d = a.d + reach;
    if (!(d > a.d && d < b.d)) return {};  // a tangent point, within rounding
    const end m{d, f.at(d)};
    if ((m.v.f < 0.0) != (side < 0.0)) {
      return {{root_between(f, low, m), root_between(f, m, high)}, 2};
    }
    (m.v.slope * side < 0.0 ? a : b) = m;
  }
  return {};
}

}  // namespace

struct G4LIDAR_HIDDEN ray_caster::beam {
  double e_x, e_y;
};

double correction_deg(double range_mm) noexcept { return atan_deg(k / range_mm - c); }

ray_caster::seen_wall ray_caster::as_seen(const wall& w, const pose& from,
                                          std::uint32_t index) noexcept {
  const sin_cos heading = sin_cos_deg(from.heading_deg);
  const auto ahead = [&](double x_m, double y_m) {
    return 1000.0 * ((x_m - from.x_m) * heading.cosine + (y_m - from.y_m) * heading.sine);
  };
  const auto right = [&](double x_m, double y_m) {
    return 1000.0 * ((x_m - from.x_m) * heading.sine - (y_m - from.y_m) * heading.cosine);
  };
  const double x1 = ahead(w.x1_m, w.y1_m);
  const double y1 = right(w.x1_m, w.y1_m);
  const double x2 = ahead(w.x2_m, w.y2_m);
  const double y2 = right(w.x2_m, w.y2_m);
  const double length = std::sqrt(squared(x2 - x1) + squared(y2 - y1));

  seen_wall seen{};
  seen.index = index;
  seen.tangent_x = (x2 - x1) / length;
  seen.tangent_y = (y2 - y1) / length;
  seen.normal_x = -seen.tangent_y;
  seen.normal_y = seen.tangent_x;
  seen.distance = seen.normal_x * x1 + seen.normal_y * y1;
  if (seen.distance < 0.0) {
    seen.normal_x = -seen.normal_x;
    seen.normal_y = -seen.normal_y;
    seen.distance = -seen.distance;
  }
  seen.along_begin = seen.tangent_x * x1 + seen.tangent_y * y1;
  seen.along_end = seen.tangent_x * x2 + seen.tangent_y * y2;
  const bool foot_on_wall = seen.along_begin <= 0.0 && seen.along_end >= 0.0;
  const double to_begin = std::sqrt(squared(x1) + squared(y1));
  const double to_end = std::sqrt(squared(x2) + squared(y2));
  seen.nearest = foot_on_wall ? seen.distance : std::min(to_begin, to_end);
  seen.farthest = std::max(to_begin, to_end);
  return seen;
}

ray_caster::ray_caster(const world& scene) {
  walls_.reserve(scene.walls.size());
  for (const wall& w : scene.walls) {
    walls_.push_back(as_seen(w, scene.lidar, static_cast<std::uint32_t>(walls_.size())));
  }
  // The index makes the order of all walls the same with every standard library.
  std::sort(walls_.begin(), walls_.end(), [](const seen_wall& a, const seen_wall& b) {
    return a.nearest < b.nearest || (a.nearest == b.nearest && a.index < b.index);
  });

  // A wall between the bearings b1 and b2, with points between the ranges d1 and d2, is hit from
  // first-level angles between b1 - correction(d1) and b2 - correction(d2) only.
  std::vector<std::vector<std::uint32_t>> seen_from(sectors);
  for (std::uint32_t i = 0; i < walls_.size(); ++i) {
    const seen_wall& w = walls_[i];
    const auto bearing_at = [&w](double along) {
      return atan2_deg(w.normal_y * w.distance + w.tangent_y * along,
                       w.normal_x * w.distance + w.tangent_x * along);
    };
    double first = bearing_at(w.along_begin);
    double width = wrap_once_deg(bearing_at(w.along_end) - first);
    if (width > 180.0) {
      first = wrap_once_deg(first + width);
      width = 360.0 - width;
    }
    constexpr double margin = 0.01;
    const double begin = first - correction_deg(std::max(w.nearest, least_range)) - margin;
    const double end = first + width - correction_deg(w.farthest) + margin;
    constexpr double per_degree = static_cast<double>(sectors) / 360.0;
    const bool all_round = w.distance < least_range || end - begin >= 359.0;
    const auto from = static_cast<std::size_t>((begin + 360.0) * per_degree);
    const auto to =
        all_round ? from + sectors - 1 : static_cast<std::size_t>((end + 360.0) * per_degree);
    for (std::size_t s = from; s <= to; ++s) seen_from[s % sectors].push_back(i);
  }
  sector_begin_.reserve(sectors + 1);
  for (const std::vector<std::uint32_t>& sector : seen_from) {
    sector_begin_.push_back(static_cast<std::uint32_t>(candidates_.size()));
    candidates_.insert(candidates_.end(), sector.begin(), sector.end());
  }
  sector_begin_.push_back(static_cast<std::uint32_t>(candidates_.size()));
}

std::optional<double> ray_caster::meet(const seen_wall& target, const beam& ray,
                                       double not_beyond_mm) noexcept {
  const double along_e = target.normal_x * ray.e_x + target.normal_y * ray.e_y;
  const double along_n = target.normal_y * ray.e_x - target.normal_x * ray.e_y;
  const gap f{along_e - c * along_n, k * along_n, target.distance};

  const double begin = std::max(target.nearest - slack, least_range);
  const double end = std::min(target.farthest + slack, not_beyond_mm);
  const auto on_wall = [&](double d) {
    const double q = k / d - c;
    const double t_e = target.tangent_x * ray.e_x + target.tangent_y * ray.e_y;
    const double t_n = target.tangent_y * ray.e_x - target.tangent_x * ray.e_y;
    const double along = d * (t_e + q * t_n) / std::sqrt(1.0 + q * q);
    return along >= target.along_begin - slack && along <= target.along_end + slack;
  };
  const auto part = [&](double low, double high) -> std::optional<double> {
    if (!(low < high)) return std::nullopt;
    const roots found = roots_between(f, {low, f.at(low)}, {high, f.at(high)});
    for (std::size_t i = 0; i < found.count; ++i) {
      if (on_wall(found.at[i])) return found.at[i];
    }
    return std::nullopt;
  };
  if (const auto near_by = part(begin, std::min(end, inflection))) return near_by;
  return part(std::max(begin, inflection), end);
}

std::optional<sighting> ray_caster::cast(double first_level_deg) const noexcept {
  const sin_cos direction = sin_cos_deg(first_level_deg);
  const beam ray{direction.cosine, direction.sine};
  constexpr double per_degree = static_cast<double>(sectors) / 360.0;
  const std::size_t sector =
      std::min(static_cast<std::size_t>(first_level_deg * per_degree), sectors - 1);

  double best = 1e9;
  std::optional<std::uint32_t> met;
  for (std::uint32_t i = sector_begin_[sector]; i < sector_begin_[sector + 1]; ++i) {
    const seen_wall& candidate = walls_[candidates_[i]];
    if (candidate.nearest > best) break;
    const std::optional<double> range = meet(candidate, ray, best);
    if (!range) continue;
    best = *range;
    met = candidate.index;
  }
  if (!met) return std::nullopt;
  return sighting{best, wrap_once_deg(first_level_deg + correction_deg(best)), *met};
}

}  // namespace g4lidar::sim
