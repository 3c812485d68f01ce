// SPDX-License-Identifier: MIT
// The second-level correction of an angle by its range, in three forms: exact, table, compact.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "g4lidar/core/angle.hpp"
#include "g4lidar/core/model_record.hpp"

namespace g4lidar {

// The sensor is mounted beside the rotation axis, so the true bearing differs from the first-level
// angle by an amount that depends on the range d (in mm) only:
//
//     atan(21.8 * (155.3 - d) / (155.3 * d)) degrees = atan(21.8 / d - 21.8 / 155.3)
//
// All forms take a range in quarters of a millimetre, which is the raw sample of a G4, and return
// degrees to be added. What is below least_range_raw is not a range: it has the correction of an
// infinitely distant target, so that the angle is the direction in which the sensor looked.
// (protocol: Point packets, second level, no return)

/// The least raw sample that is a range. In smaller ones the 14 upper bits are 0: nothing came back,
/// and the lower two bits are flags. (protocol: Point packets, no return)
inline constexpr std::uint16_t least_range_raw = 4;

/// The distance of the laser from the rotation axis, in millimetres. (protocol: Point packets)
inline constexpr double correction_offset_mm = 21.8;
/// The range at which the correction is 0, in millimetres.
inline constexpr double correction_zero_mm = 155.3;

/// The correction of an infinitely distant target, in degrees: atan(-21.8 / 155.3).
inline constexpr double far_correction_deg = no_return_correction_deg(correction_kind::triangle);

/// The arctangent in degrees, without libm. *Pure.* Within 3e-14 degrees of the true value; not a number
/// for what is not a number.
[[nodiscard]] constexpr double arctangent_deg(double x) noexcept {
  // atan(1 / x) = 90 - atan(x) reduces x to at most 1; the nearest eighth, whose arctangent is in a
  // table, reduces it to at most 1/16; for that a short series is exact enough.
  constexpr std::array<double, 9> eighths_deg{0.0,
                                              7.125016348901797561953,
                                              14.03624346792647858289,
                                              20.55604521958346430829,
                                              26.56505117707798935157,
                                              32.00538320808349556079,
                                              36.86989764584402129686,
                                              41.18592516570964580509,
                                              45.0};
  if (x != x) return x;
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

/// The formula in double precision. *Pure.* For reference, tests and tables; about 10 ns per sample
/// on a desktop processor.
struct exact_correction {
  /// For a range in quarters of a millimetre, in degrees. Below `least` it is none.
  [[nodiscard]] constexpr double operator()(std::int32_t raw,
                                            std::int32_t least = least_range_raw) const noexcept {
    if (raw < least) return far_correction_deg;
    const double range_mm = raw / 4.0;
    return arctangent_deg(correction_offset_mm * (correction_zero_mm - range_mm) /
                          (correction_zero_mm * range_mm));
  }
};

/// The formula in single precision, without a table, libm or a branch: small enough for a
/// microcontroller, and a compiler can vectorize a loop over it. *Pure.* Within 2e-5 degrees of the
/// exact form for every sample.
struct compact_correction {
  // With x the fraction of the formula, atan(x) = centre + atan((x - c) / (1 + x c)), where c is
  // the tangent of the centre. All corrections are within 48.7 degrees of this centre, so one
  // polynomial is sufficient; and since x is 87.2 / raw - 21.8 / 155.3, the new fraction is the
  // ratio of two linear functions of the sample, scaled here so that the upper one is zero_raw -
  // raw.
  /// The middle of all corrections and the two functions of the sample, see above.
  static constexpr float centre_deg = 40.675655774F;
  /// The sample at which the upper function is 0.
  static constexpr float zero_raw = 87.22004292F;
  /// The lower function for a sample of 0.
  static constexpr float below_0 = 74.95661986F;
  /// The slope of the lower function.
  static constexpr float below_1 = 0.8795656197F;

  /// atan(t) / t in degrees as a polynomial in t * t, for t <= 1.14; multiplied by t, it is within
  /// 2e-6 degrees.
  static constexpr std::array<float, 9> coefficients{
      57.2957485712F,  -19.0970140142F, 11.4353011874F,   -8.01804181227F, 5.70921625447F,
      -3.59175127002F, 1.71076904796F,  -0.515605582546F, 0.0713759217089F};

  /// For a range in quarters of a millimetre, in degrees. Below `least` it is none.
  [[nodiscard]] constexpr float operator()(std::int32_t raw,
                                           std::int32_t least = least_range_raw) const noexcept {
    // A sample without range counts as a very long range; a branch would prevent vectorization.
    const std::uint32_t is_none = raw < least ? 0xFFFF'FFFFU : 0U;
    const float sample = static_cast<float>(raw) + masked(is_none, 1e9F);
    const float t = (zero_raw - sample) / (below_0 + below_1 * sample);
    return centre_deg + t * arctangent_ratio(t * t);
  }

  /// The polynomial of `coefficients` at `x` = t * t. *Pure.* In pairs, and pairs of pairs: shorter
  /// dependency chains, and no loop to unroll.
  [[nodiscard]] static constexpr float arctangent_ratio(float x) noexcept {
    const auto& c = coefficients;
    const float x2 = x * x;
    const float low = (c[0] + x * c[1]) + x2 * (c[2] + x * c[3]);
    const float high = (c[4] + x * c[5]) + x2 * (c[6] + x * c[7] + x2 * c[8]);
    return low + x2 * x2 * high;
  }
};

/// The exact form, rounded to single precision, for all 65,536 samples. 256 KiB: make it static or
/// allocate it on the heap, not on a small stack. The constructor fills it, which takes some
/// milliseconds; after that *any thread* may read it. Within 4e-6 degrees of the exact form.
class table_correction {
 public:
  /// Fills the table.
  constexpr table_correction() noexcept {
    for (std::size_t raw = 0; raw < degrees_.size(); ++raw) {
      degrees_[raw] = static_cast<float>(exact_correction{}(static_cast<std::uint16_t>(raw)));
    }
  }

  /// For a raw sample, in degrees.
  [[nodiscard]] constexpr float operator()(std::uint16_t raw) const noexcept {
    return degrees_[raw];
  }

 private:
  std::array<float, 65536> degrees_{};
};

/// The correction of an SCL, atan(17.8 / d), in single precision, as in compact_correction. *Pure.*
/// Within 2e-5 degrees of the formula for every sample; 0 for no return.
struct scl_correction {
  /// For a range in quarters of a millimetre, in degrees.
  [[nodiscard]] constexpr float operator()(std::int32_t raw) const noexcept {
    // atan(x) = 45 + atan((x - 1) / (x + 1)), and x is 71.2 / raw.
    const auto sample = static_cast<float>(raw);
    const float t = (71.2F - sample) / (71.2F + sample);
    const float degrees = 45.0F + t * compact_correction::arctangent_ratio(t * t);
    return masked(~negative_mask(sample - least_range_raw), degrees);
  }
};

/// The angles of the device are those of its returns. *Pure.*
struct no_correction {
  /// 0 for every range.
  [[nodiscard]] constexpr float operator()(std::int32_t /*raw*/) const noexcept { return 0.0F; }
};

/// The corrections that decode() accepts: sample in, degrees out, in the precision of the
/// arithmetic.
template <class Form>
concept correction_form = requires(const Form& form, std::uint16_t raw) {
  { form(raw) } noexcept -> std::floating_point;
};

}  // namespace g4lidar
