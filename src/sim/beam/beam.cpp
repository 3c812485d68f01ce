// SPDX-License-Identifier: MIT
// Where a curved beam hits straight walls and discs. With q(d) = tan(correction(d)) = k/d - c, the point of
// the beam at the first-level angle theta and range d is
//     P(d) = (d e + (k - c d) n) / g(d),   g(d) = sqrt(1 + q(d)^2),
// e pointing towards theta and n 90 degrees further. It is on the line N.P = h of a wall where
//     f(d) = d N.e + (k - c d) N.n - h g(d) = 0.
// Without g that is a straight line: the laser beam beside the centre. g is convex up to the range
// at which its curvature changes its sign, and concave from there on, and f likewise. So there are
// at most two roots in either part, and a reliable way to find all of them without a trigonometric
// function.
//
// It is on a disc where F(d) = |P(d) - C|^2 - radius^2 = 0. F is convex from 100 mm on, for the
// discs that a world may have. So Newton steps from the nearest range at which a hit is possible
// never pass the first root. Nearer than that, steps of 1 mm search for it.
//
// The inflection of a shape is where 0 = 3k - 2cd + 2(k - cd) q^2. With c = 0 there is none, and with
// k = c = 0 the beam is straight: then f is a straight line, too, and F a parabola.
#include "sim/exact.hpp"

#include "beam.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "sim/arithmetic.hpp"

namespace g4lidar::sim {
namespace {

constexpr double slack = 1e-6;  // mm; walls are extended by it, so that corners are closed

double squared(double x) noexcept { return x * x; }

// f of the comment at the top, for one wall and one beam.
struct gap {
  double slope;   // N.e - c N.n
  double offset;  // k N.n
  double h;
  beam_shape shape;

  struct value {
    double f;
    double slope;
  };

  [[nodiscard]] value at(double d) const noexcept {
    const double k_by_d = shape.offset_mm / d;
    const double q = k_by_d - shape.slope;
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
template <class Function>
double root_between(const Function& f, end low, end high) noexcept {
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

// F of the comment at the top, for one disc and one beam.
struct disc_gap {
  double centre_e;
  double centre_n;
  double radius;
  beam_shape shape;

  [[nodiscard]] gap::value at(double d) const noexcept {
    const double k_by_d = shape.offset_mm / d;
    const double q = k_by_d - shape.slope;
    const double g = std::sqrt(1.0 + q * q);
    const double along = d / g;
    const double along_slope = (1.0 + q * k_by_d / (g * g)) / g;
    const double to_e = along - centre_e;
    const double to_n = along * q - centre_n;
    return {squared(to_e) + squared(to_n) - squared(radius),
            2.0 * (to_e * along_slope + to_n * (q * along_slope - k_by_d / g))};
  }
};

// The first root from `at` on, where F is positive and from where it is convex.
std::optional<double> first_root(const disc_gap& f, end at, double not_beyond) noexcept {
  for (int i = 0; i < 100; ++i) {
    if (at.v.slope >= 0.0) return std::nullopt;
    const double next = at.d - at.v.f / at.v.slope;
    if (next > not_beyond) return std::nullopt;
    if (next - at.d <= 1e-10) return next;
    at = {next, f.at(next)};
    if (at.v.f <= 0.0) break;
  }
  return at.d;
}

}  // namespace

double correction_deg(double range_mm, const beam_shape& shape) noexcept {
  return atan_deg(shape.offset_mm / range_mm - shape.slope);
}

seen_wall as_seen(const wall& w, const pose& viewpoint, const sin_cos& heading,
                  std::uint32_t index) noexcept {
  const auto ahead = [&](double x_m, double y_m) {
    return 1000.0 * ((x_m - viewpoint.x_m) * heading.cosine + (y_m - viewpoint.y_m) * heading.sine);
  };
  const auto right = [&](double x_m, double y_m) {
    return 1000.0 * ((x_m - viewpoint.x_m) * heading.sine - (y_m - viewpoint.y_m) * heading.cosine);
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

std::optional<double> meet(const seen_wall& target, const beam& ray,
                           double not_beyond_mm) noexcept {
  const double along_e = target.normal_x * ray.e_x + target.normal_y * ray.e_y;
  const double along_n = target.normal_y * ray.e_x - target.normal_x * ray.e_y;
  const double offset_mm = ray.shape.offset_mm;
  const double slope = ray.shape.slope;
  const double inflection = ray.shape.inflection_mm;
  const gap f{along_e - slope * along_n, offset_mm * along_n, target.distance, ray.shape};

  const double begin = std::max(target.nearest - slack, least_range_mm);
  const double end = std::min(target.farthest + slack, not_beyond_mm);
  const auto on_wall = [&](double d) {
    const double q = offset_mm / d - slope;
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

std::optional<double> meet(const seen_disc& target, const beam& ray,
                           double not_beyond_mm) noexcept {
  constexpr double convex_from = 100.0;
  const disc_gap f{target.x * ray.e_x + target.y * ray.e_y, target.y * ray.e_x - target.x * ray.e_y,
                   target.radius, ray.shape};
  const double distance = std::sqrt(squared(target.x) + squared(target.y));
  const double begin = std::max(std::fabs(distance - target.radius) - slack, least_range_mm);
  const double last = std::min(distance + target.radius + slack, not_beyond_mm);
  if (!(begin < last)) return std::nullopt;

  end low{begin, f.at(begin)};
  const bool is_inside = low.v.f < 0.0;  // the lidar is: it sees the far side
  while (low.d < convex_from) {
    const double next = low.d + 1.0;
    if (next > last) break;
    const end high{next, f.at(next)};
    if ((high.v.f < 0.0) != is_inside) return root_between(f, low, high);
    low = high;
  }
  if (!is_inside) return first_root(f, low, last);
  const end high{last, f.at(last)};
  if (high.v.f < 0.0) return std::nullopt;
  return root_between(f, low, high);
}

}  // namespace g4lidar::sim
