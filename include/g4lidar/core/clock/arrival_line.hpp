// SPDX-License-Identifier: MIT
// The straight line below points that are above it by unknown amounts, and its uncertainty.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "g4lidar/detail/api.hpp"

namespace g4lidar {

/// e^-t for t >= 0, without libm. *Pure.* Within 1e-9 of the true value; 1 for a negative one.
[[nodiscard]] constexpr double exp_minus(double t) noexcept {
  constexpr double ln_2 = 0.69314718055994531;
  if (!(t < 600.0)) return 0.0;
  if (t < 0.0) return 1.0;
  const auto halvings = static_cast<std::int64_t>(t / ln_2);
  const double rest = t - static_cast<double>(halvings) * ln_2;
  double series = 1.0;
  for (int i = 11; i >= 1; --i) series = 1.0 - rest / i * series;
  return series * std::bit_cast<double>(static_cast<std::uint64_t>(1023 - halvings) << 52);
}

/// The square root of `x`, 0 for a negative one, without libm. *Pure.* Relative error at most 1e-9.
[[nodiscard]] constexpr double square_root(double x) noexcept {
  if (!(x > 0.0)) return 0.0;
  constexpr std::uint64_t half_bias = std::uint64_t{511} << 52;
  double root = std::bit_cast<double>((std::bit_cast<std::uint64_t>(x) >> 1) + half_bias);
  for (int i = 0; i < 4; ++i) root = 0.5 * (root + x / root);
  return root;
}

/// The line y = offset + slope * x.
struct line_estimate {
  double offset = 0.0;
  double offset_deviation = 0.0;  ///< Standard deviation.
  double slope = 0.0;
  double slope_deviation = 0.0;
  double mean_delay = 0.0;  ///< The mean distance of a point above the line.
};

/// Estimates the line. *Single thread, never allocates.*
///
/// If the points are above a line by exponentially distributed amounts, and c is the greatest
/// distance by which the offset of a line can be below all n points, the line has a probability
/// proportional to e^(n (c + slope * mean x) / mean delay). For each range of slopes, c is
/// determined by one corner of the lower hull of the points, so the logarithm is linear there, and
/// the mean line and its deviation are sums of closed forms over the corners.
class line_under_points {
  /// The slopes for which one corner limits the line, and the height at the mean x at both ends.
  struct piece {
    double x, y;
    double from, to;
    double height_from, height_to;
  };

  template <class Taker>
  constexpr void for_each_piece(double lowest, double highest, Taker take) const noexcept {
    const double mean_x = sum_x_ / count_;
    double from = lowest;
    for (std::size_t i = corners_; i-- > 0;) {  // from the left: slopes increase
      double to = i == 0 ? highest : slope_right_of(i);
      if (to > highest) to = highest;
      if (to <= from) continue;
      const double arm = mean_x - x_[i];
      take(piece{x_[i], y_[i], from, to, y_[i] + from * arm, y_[i] + to * arm});
      from = to;
    }
  }

  [[nodiscard]] constexpr double slope_to(std::size_t i, double x, double y) const noexcept {
    return (y_[i] - y) / (x_[i] - x);
  }
  [[nodiscard]] constexpr double slope_right_of(std::size_t i) const noexcept {
    return slope_to(i - 1, x_[i], y_[i]);
  }

 public:
  /// The maximum number of points.
  static constexpr std::size_t capacity = 64;

  /// Adds a point to the left of all others; up to `capacity` points.
  constexpr void add_left(double x, double y) noexcept {
    while (corners_ >= 2 && slope_to(corners_ - 1, x, y) >= slope_right_of(corners_ - 1)) {
      --corners_;
    }
    x_[corners_] = x;
    y_[corners_] = y;
    ++corners_;
    count_ += 1.0;
    sum_x_ += x;
    sum_y_ += y;
  }

  /// The mean of all lines whose slope is in [lowest, highest], lowest < highest. There must be at
  /// least one point. `usual_delay` is the assumed distance of points above the line if there are
  /// few points.
  [[nodiscard]] constexpr line_estimate estimate(double lowest, double highest,
                                                 double usual_delay) const noexcept {
    const double best = height_of_best(lowest, highest);
    const double above = sum_y_ - count_ * best;
    const double free = count_ > 3.0 ? count_ - 2.0 : 1.0;
    line_estimate result;
    result.mean_delay = ((above > 0.0 ? above : 0.0) + 2.0 * usual_delay / count_) / free;
    const double lift = result.mean_delay / count_;  // of the line below the lowest points
    sums all;
    for_each_piece(lowest, highest, [&](const piece& p) { add(all, p, best, 1.0 / lift, lowest); });
    const double below = all.offset / all.weight;
    const double tilt = all.slope / all.weight;
    result.offset = y_[0] + below - lift;
    result.offset_deviation = square_root(all.offset_2 / all.weight - below * below + lift * lift);
    result.slope = lowest + tilt;
    result.slope_deviation = square_root(all.slope_2 / all.weight - tilt * tilt);
    return result;
  }

 private:
  struct sums {
    double weight = 0.0;
    double offset = 0.0, offset_2 = 0.0;  // minus y_[0], for precision
    double slope = 0.0, slope_2 = 0.0;    // minus the lowest slope
  };
  /// The integrals of u^k e^(-fall u), k = 0, 1, 2, over u in [0, 1].
  struct moments {
    double zeroth, first, second;
  };

  [[nodiscard]] static constexpr moments moments_of(double fall) noexcept {
    if (fall < 1e-3) return {1.0 - fall / 2, 0.5 - fall / 3, 1.0 / 3 - fall / 4};
    const double end = exp_minus(fall);
    return {(1.0 - end) / fall, (1.0 - end * (1.0 + fall)) / (fall * fall),
            (2.0 - end * (fall * fall + 2.0 * fall + 2.0)) / (fall * fall * fall)};
  }

  constexpr void add(sums& all, const piece& p, double best, double steepness,
                     double lowest) const noexcept {
    // Along u from the more probable end of the piece to the other end.
    const bool falling = p.height_from > p.height_to;
    const double high = falling ? p.height_from : p.height_to;
    const double low = falling ? p.height_to : p.height_from;
    const double start = falling ? p.from : p.to;
    const double way = falling ? p.to - p.from : p.from - p.to;
    const moments m = moments_of(steepness * (high - low));
    const double weight = exp_minus(steepness * (best - high)) * (p.to - p.from);
    const auto mean = [&](double a, double b) { return weight * (a * m.zeroth + b * m.first); };
    const auto mean_square = [&](double a, double b) {
      return weight * (a * a * m.zeroth + 2.0 * a * b * m.first + b * b * m.second);
    };
    const double offset = p.y - start * p.x - y_[0];
    all.weight += weight * m.zeroth;
    all.offset += mean(offset, -way * p.x);
    all.offset_2 += mean_square(offset, -way * p.x);
    all.slope += mean(start - lowest, way);
    all.slope_2 += mean_square(start - lowest, way);
  }

  /// The height of the most probable line at the mean x.
  [[nodiscard]] constexpr double height_of_best(double lowest, double highest) const noexcept {
    double best = -1e300;
    for_each_piece(lowest, highest, [&](const piece& p) {
      if (p.height_from > best) best = p.height_from;
      if (p.height_to > best) best = p.height_to;
    });
    return best;
  }

  std::array<double, capacity> x_{};  // the corners of the lower hull, from the right
  std::array<double, capacity> y_{};
  std::size_t corners_ = 0;
  double count_ = 0.0;  // of all points
  double sum_x_ = 0.0;
  double sum_y_ = 0.0;
};

}  // namespace g4lidar
