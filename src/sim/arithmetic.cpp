// SPDX-License-Identifier: MIT
// Sine and cosine by a Taylor series up to 45 degrees, arctangent by a table of nine values and a
// series.
#include "sim/exact.hpp"

#include "sim/arithmetic.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "g4lidar/core/angle.hpp"
#include "g4lidar/detail/saturating.hpp"

namespace g4lidar::sim {
namespace {

constexpr double radians_per_degree = std::numbers::pi / 180.0;
constexpr double degrees_per_radian = 180.0 / std::numbers::pi;

// The arctangents of 0, 1/8, ... 1.
constexpr std::array<double, 9> atan_of_eighths{
    0.0,
    0.12435499454676143503,
    0.24497866312686415417,
    0.35877067027057222040,
    0.46364760900080611621,
    0.55859931534356243597,
    0.64350110879328438680,
    0.71882999962162450542,
    0.78539816339744830962,
};

// The sum of c[0] + c[1] x + c[2] x^2 + ..., the highest power first.
template <std::size_t N>
constexpr double polynomial(const std::array<double, N>& c, double x) noexcept {
  double sum = c[N - 1];
  for (std::size_t i = N - 1; i > 0; --i) sum = sum * x + c[i - 1];
  return sum;
}

// The series without their first terms, in x^2. The first omitted term is below 1e-19 of the sum.
constexpr std::array<double, 8> sine_series{
    -1.0 / 6.0,        1.0 / 120.0,        -1.0 / 5040.0,          1.0 / 362880.0,
    -1.0 / 39916800.0, 1.0 / 6227020800.0, -1.0 / 1307674368000.0, 1.0 / 355687428096000.0};
constexpr std::array<double, 8> cosine_series{
    1.0 / 24.0,        -1.0 / 720.0,         1.0 / 40320.0,          -1.0 / 3628800.0,
    1.0 / 479001600.0, -1.0 / 87178291200.0, 1.0 / 20922789888000.0, -1.0 / 6402373705728000.0};
constexpr std::array<double, 6> atan_series{-1.0 / 3.0, 1.0 / 5.0,   -1.0 / 7.0,
                                            1.0 / 9.0,  -1.0 / 11.0, 1.0 / 13.0};

}  // namespace

sin_cos sin_cos_deg(double degrees) noexcept {
  // The nearest multiple of 90 is subtracted exactly; the rest is at most 45.
  const double turned = degrees * (1.0 / 90.0);
  if (!detail::fits<std::int64_t>(turned)) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    return {none, none};
  }
  const auto quarter = static_cast<std::int64_t>(turned < 0.0 ? turned - 0.5 : turned + 0.5);
  const double x = (degrees - static_cast<double>(quarter) * 90.0) * radians_per_degree;
  const double x2 = x * x;
  const double s = x + x * x2 * polynomial(sine_series, x2);
  const double c = 1.0 - (0.5 * x2 - x2 * x2 * polynomial(cosine_series, x2));
  switch (quarter & 3) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

double atan_deg(double x) noexcept {
  if (x != x) return x;
  const double size = x < 0.0 ? -x : x;
  const bool steep = size > 1.0;
  const double y = steep ? 1.0 / size : size;
  const auto eighths = static_cast<std::size_t>(y * 8.0 + 0.5);
  const double near_by = static_cast<double>(eighths) * 0.125;
  const double z = (y - near_by) / (1.0 + y * near_by);  // at most 1/16
  const double z2 = z * z;
  const double flat = atan_of_eighths[eighths] + (z + z * z2 * polynomial(atan_series, z2));
  const double degrees = (steep ? std::numbers::pi / 2.0 - flat : flat) * degrees_per_radian;
  return x < 0.0 ? -degrees : degrees;
}

double atan2_deg(double y, double x) noexcept {
  if (x == 0.0 && y == 0.0) return 0.0;
  const double width = x < 0.0 ? -x : x;
  const double height = y < 0.0 ? -y : y;
  double degrees = width >= height ? atan_deg(height / width) : 90.0 - atan_deg(width / height);
  if (x < 0.0) degrees = 180.0 - degrees;
  if (y < 0.0) degrees = 360.0 - degrees;
  return wrap_once_deg(degrees);
}

}  // namespace g4lidar::sim
