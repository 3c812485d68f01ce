// SPDX-License-Identifier: MIT
// Sine, cosine and arctangent in double precision that give the same bits on every processor.
#pragma once

namespace g4lidar::sim {

/// Sine and cosine of one angle.
struct sin_cos {
  double sine;
  double cosine;
};

/// Sine and cosine of `degrees`, below 1e9 in magnitude. *Pure.* Within 3e-16 of the true values; uses only
/// + - * /, so that all IEEE 754 machines agree to the last bit. Those of greater numbers are less exact; of
/// what is not a number, and from 2^63 quarter turns on, they are not a number.
[[nodiscard]] sin_cos sin_cos_deg(double degrees) noexcept;

/// The angle whose tangent is `x`, in degrees, -90 to 90; NaN for NaN. *Pure.* Accepts infinities.
/// Within 3e-14 degrees of the true value (5e-16 radians); uses only + - * /.
[[nodiscard]] double atan_deg(double x) noexcept;

/// The direction of (x, y) from (0, 0), in degrees [0, 360), from the x axis towards the y axis; 0
/// for (0, 0). *Pure.*
[[nodiscard]] double atan2_deg(double y, double x) noexcept;

}  // namespace g4lidar::sim
