// SPDX-License-Identifier: MIT
// The second-level correction of an angle by its range, in three forms: exact, table, compact.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "g4lidar/angle.hpp"

namespace g4lidar {

// The sensor looks at its target from beside the point that it turns about, so the true bearing
// differs from the first-level angle by an amount that follows from the range d (in mm) alone:
//
//     atan(21.8 * (155.3 - d) / (155.3 * d)) degrees = atan(21.8 / d - 21.8 / 155.3)
//
// All forms take the sample as it came (quarters of a millimetre) and give degrees to be added. A
// sample of 0 is no range and has the correction 0. (protocol: Point packets, second level)

/// The two lengths of the correction, in millimetres.
inline constexpr double correction_offset_mm = 21.8;
inline constexpr double correction_zero_mm = 155.3;

/// The correction of a target infinitely far away, in degrees: atan(-21.8 / 155.3).
inline constexpr double far_correction_deg = -7.9905962679645856;

/// The arctangent in degrees, without libm. *Pure.* Within 3e-14 degrees of the true value for any
/// finite `x`.
[[nodiscard]] constexpr double arctangent_deg(double x) noexcept {
  // atan(1 / x) = 90 - atan(x) brings x to at most 1; the nearest eighth, whose arctangent is
  // tabled, brings it to at most 1/16; there a short series is exact enough.
  constexpr std::array<double, 9> eighths_deg{
      0.0,
      7.125016348901797561953,
      14.03624346792647858289,
      20.55604521958346430829,
      26.56505117707798935157,
      32.00538320808349556079,
      36.86989764584402129686,
      41.18592516570964580509,
      45.0};
  const double magnitude = x < 0.0 ? -x : x;
  const bool steep = magnitude > 1.0;
  const double slope = steep ? 1.0 / magnitude : magnitude;
  const auto eighth = static_cast<std::size_t>(slope * 8.0 + 0.5);
  const double tabled = static_cast<double>(eighth) / 8.0;
  const double t = (slope - tabled) / (1.0 + slope * tabled);
  const double t2 = t * t;
  double series = 1.0 / 13.0;
  for (int odd = 11; odd >= 1; odd -= 2) series = 1.0 / odd - t2 * series;
  const double shallow = eighths_deg[eighth] + t * series * (180.0 / std::numbers::pi);
  const double result = steep ? 90.0 - shallow : shallow;
  return x < 0.0 ? -result : result;
}

/// The formula in double precision. *Pure.* For reference, tests and tables; about 10 ns a sample
/// on a desktop processor.
struct exact_correction {
  [[nodiscard]] constexpr double operator()(std::uint16_t raw) const noexcept {
    if (raw == 0) return 0.0;
    const double range_mm = raw / 4.0;
    return arctangent_deg(correction_offset_mm * (correction_zero_mm - range_mm) /
                          (correction_zero_mm * range_mm));
  }
};

/// The formula in single precision, without a table, libm or a branch: small enough for a
/// microcontroller, and a loop over it turns into vector instructions. *Pure.* Within 1e-5 degrees
/// of the exact form for every sample.
struct compact_correction {
  [[nodiscard]] constexpr float operator()(std::uint16_t raw) const noexcept {
    // The tangent is the fraction above / below; taken upside down where it is steep, its one
    // division stays and its arctangent is needed between -0.14 and 1 only.
    const auto below = static_cast<float>(raw);
    const float above = 87.2F - below * 0.14037347F;  // 4 * 21.8, and 21.8 / 155.3
    const std::uint32_t steep = negative_mask(below - above);
    const float t = (masked(~steep, above) + masked(steep, below)) /
                    (masked(~steep, below) + masked(steep, above));
    const float shallow = t * polynomial(t * t);
    const float sign = 1.0F - masked(steep, 2.0F);
    const std::uint32_t measured = negative_mask(0.5F - below);
    return masked(measured, masked(steep, 90.0F) + sign * shallow);
  }

  /// atan(t) / t in degrees as a polynomial in t * t, for -0.15 <= t <= 1: within 2.2e-6 degrees.
  static constexpr std::array<float, 8> coefficients{
      57.29574144F, -19.0966035F, 11.42854028F, -7.969057729F,
      5.524572132F, -3.20354035F, 1.25265521F,  -0.232309587F};

 private:
  [[nodiscard]] static constexpr float polynomial(float t2) noexcept {
    float sum = coefficients[7];
    for (std::size_t i = 7; i-- > 0;) sum = coefficients[i] + t2 * sum;
    return sum;
  }
};

/// The exact form, rounded to single precision, for all 65,536 samples. 256 KiB: make it static or
/// put it on the heap, never on a small stack. Fills itself when made, in some milliseconds; then
/// *single writer none, any reader*. Within 4e-6 degrees of the exact form.
class table_correction {
 public:
  constexpr table_correction() noexcept {
    for (std::size_t raw = 0; raw < degrees_.size(); ++raw) {
      degrees_[raw] = static_cast<float>(exact_correction{}(static_cast<std::uint16_t>(raw)));
    }
  }

  [[nodiscard]] constexpr float operator()(std::uint16_t raw) const noexcept {
    return degrees_[raw];
  }

 private:
  std::array<float, 65536> degrees_{};
};

/// What decode() takes for a correction: sample in, degrees out, in the precision to work in.
template <class Form>
concept correction_form = requires(const Form& form, std::uint16_t raw) {
  { form(raw) } noexcept -> std::floating_point;
};

}  // namespace g4lidar
