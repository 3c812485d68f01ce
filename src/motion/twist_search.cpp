// SPDX-License-Identifier: MIT
#include "motion/twist_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <span>

namespace g4lidar {
namespace {

constexpr std::size_t fewest_matches = 40;
constexpr double reach_m = 0.5;  // from a point to the nearest one of the other revolution
constexpr double least_noise_m = 0.002;
// The first iterations count distances of this size, too: in a corridor only the wall at its end shows the speed, and
// without a previous estimate that wall is off by the way of a whole revolution.
constexpr double widest_m = 0.1;
constexpr double most_noise_m = 0.05;  // of two revolutions that fit
constexpr double unknown_m_per_s = 10.0;
constexpr double known_m_per_s = 0.3;  // the greatest standard deviation of what is known
constexpr double fastest_m_per_s = 10.0;
constexpr double same_start_rad = 0.02;
constexpr double converged_deviations = 0.2;  // the correction after which the search ends
constexpr double accepted_deviations = 0.5;   // the same after the last iteration
constexpr double most_turn_rad = 1.4;         // within a revolution

/// How much a distance counts: 1 on the line, little beyond 3 widths (Geman and McClure).
double weight_of(double distance, double width) noexcept {
  return 1.0 / squared(1.0 + squared(distance / (3.0 * width)));
}

double period_s(const scan_points& before, const scan_points& after) noexcept {
  return static_cast<double>(after.first_ns() - before.first_ns()) * 1e-9;
}

}  // namespace

twist_estimate unknown_twist(twist_status why, const twist_2d& last) noexcept {
  constexpr double variance = unknown_m_per_s * unknown_m_per_s;
  return {last, {variance, 0.0, 0.0, 0.0, variance, 0.0, 0.0, 0.0, variance}, {}, why};
}

double coarse_yaw_rate(const scan_points& before, const scan_points& after) noexcept {
  constexpr std::size_t directions = scan_points::directions;
  constexpr std::size_t widest = 75;      // degrees
  constexpr std::int32_t farthest = 300;  // mm; a larger difference has no more weight
  std::array<std::int32_t, directions + 2 * widest> a;  // from -widest to 360 + widest degrees
  for (std::size_t i = 0; i < a.size(); ++i)
    a[i] = before.profile()[(i + directions - widest) % directions];
  const auto& b = after.profile();
  double least = std::numeric_limits<double>::max();
  std::size_t best = widest;
  for (std::size_t k = 0; k <= 2 * widest; ++k) {
    const std::size_t shift =
        k % 2 == 0 ? widest + k / 2 : widest - (k + 1) / 2;  // of equals the smallest turn
    std::int32_t sum = 0;
    std::int32_t both = 0;
    for (std::size_t i = 0; i < directions; ++i) {
      const bool are_returns = std::min(a[i + shift], b[i]) > 0;
      sum += are_returns ? std::min(std::abs(a[i + shift] - b[i]), farthest) : 0;
      both += are_returns ? 1 : 0;
    }
    if (both < 30 || sum >= least * both) continue;
    least = static_cast<double>(sum) / both;
    best = shift;
  }
  const double turn_deg = static_cast<double>(best) - static_cast<double>(widest);
  return turn_deg * (std::numbers::pi / 180.0) / period_s(before, after);
}

twist_estimate twist_search::find(const scan_points& before, const scan_points& after,
                                  const twist_2d& last) noexcept {
  constexpr int trial_iterations = 3;
  constexpr int iterations = 12;
  const double longest_s = std::max(period_s(before, after),
                                    static_cast<double>(after.last_ns() - after.first_ns()) * 1e-9);
  const auto is_possible = [&](const twist_2d& twist) {
    return std::hypot(twist.x_m_per_s, twist.y_m_per_s) <= fastest_m_per_s &&
           std::abs(twist.yaw_rad_per_s) * longest_s <= most_turn_rad;
  };

  // From each start a few iterations with a part of the points; not needed if both are about the same.
  const std::size_t trial_step = std::max<std::size_t>(1, after.size() / 250);
  const twist_2d starts[] = {last,
                             {last.x_m_per_s, last.y_m_per_s, coarse_yaw_rate(before, after)}};
  const double apart_rad =
      std::abs(starts[1].yaw_rad_per_s - last.yaw_rad_per_s) * period_s(before, after);
  twist_2d twist = last;
  double least = std::numeric_limits<double>::max();
  for (twist_2d trial : std::span(starts).first(apart_rad < same_start_rad ? 0 : 2)) {
    for (int i = 0; i < trial_iterations && is_possible(trial); ++i) {
      match_points(before, after, trial, trial_step);
      if (matched_ < fewest_matches / 2 || correct(trial, inform(widest_m)) < converged_deviations)
        break;
    }
    if (!is_possible(trial)) continue;
    match_points(before, after, trial, trial_step);
    if (misfit() >= least) continue;
    least = misfit();
    twist = trial;
  }

  information info{};
  double corrected = std::numeric_limits<double>::max();
  double width = widest_m;
  for (int i = 0; i < iterations && corrected >= converged_deviations; ++i, width *= 0.3) {
    if (!is_possible(twist)) return unknown_twist(twist_status::no_correspondence, last);
    match_points(before, after, twist, 1);
    if (matched_ < fewest_matches) return unknown_twist(twist_status::too_few_returns, last);
    info = inform(width);
    corrected = correct(twist, info);
    if (width > info.noise) corrected = std::numeric_limits<double>::max();
  }
  if (corrected > accepted_deviations || !fits(info))
    return unknown_twist(twist_status::no_correspondence, last);
  return describe(twist, info);
}

void twist_search::match_points(const scan_points& before, const scan_points& after,
                                const twist_2d& twist, std::size_t step) noexcept {
  const std::int64_t middle_ns = after.first_ns();
  before.place(twist, middle_ns, before_);
  after.place(twist, middle_ns, after_);
  lines_.build(before_, before.size());
  matched_ = 0;
  tried_ = 0;
  const double period = period_s(before, after);
  for (std::size_t i = 0; i < after.size(); i += step) {
    const double x = after_.x[i];
    const double y = after_.y[i];
    if (!lines_.has_direction(x, y))
      continue;  // the other revolution is a piece, or sees no surface there
    ++tried_;
    const std::size_t k = lines_.nearest(x, y, reach_m);
    if (k == line_map::none) continue;
    const fitted_line& line = lines_[k];
    // As if the motion between the two times were along the axes of the common frame. A slope that has the curve of the
    // path in it would see, of a lidar that turns in a corridor, the speed along it, too: by the assumption that the
    // twist is constant, not from the walls.
    const double t = period + after.seconds(i) - before.seconds(k);
    matches_[matched_++] = {
        {t * line.normal_x, t * line.normal_y, t * (line.normal_y * x - line.normal_x * y)},
        {t * line.normal_y, -t * line.normal_x, -t * (line.normal_x * x + line.normal_y * y)},
        line.normal_x * (x - line.x) + line.normal_y * (y - line.y),
        line.normal_variance,
        line.variance};
  }
}

double twist_search::misfit() const noexcept {
  constexpr double size = 0.05;
  auto sum = static_cast<double>(tried_ - matched_);
  for (const match& m : std::span(matches_).first(matched_))
    sum += squared(m.distance) / (squared(m.distance) + squared(size));
  return sum / static_cast<double>(std::max<std::size_t>(tried_, 1));
}

double twist_search::noise() noexcept {
  const std::span<double> all = std::span(distances_).first(matched_);
  for (std::size_t i = 0; i < matched_; ++i) all[i] = std::abs(matches_[i].distance);
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(matched_ / 2);
  std::ranges::nth_element(all, middle);
  return std::max(1.4826 * *middle, least_noise_m);  // of normally distributed distances
}

twist_search::information twist_search::inform(double width) noexcept {
  information made{};
  made.noise = noise();
  width = std::max(width, made.noise);
  double lever2 = 0.0;
  double times2 = 0.0;
  for (const match& m : std::span(matches_).first(matched_)) {
    lever2 += squared(m.slope[2]) + squared(m.sideways[2]);
    times2 += squared(m.slope[0]) + squared(m.slope[1]);
  }
  made.lever = std::clamp(std::sqrt(lever2 / std::max(times2, 1e-12)), 0.1, 100.0);

  matrix_3 known{};
  matrix_3
      apparent{};  // what the lines seem to know about the motion along them, because their directions have errors
  vector_3 gradient{};
  double line_variance = 0.0;
  for (const match& m : std::span(matches_).first(matched_)) {
    const double weight = weight_of(m.distance, width);
    line_variance += m.variance;
    const vector_3 slope = {m.slope[0], m.slope[1], m.slope[2] / made.lever};
    add_square(known, slope, weight);
    add_square(apparent, {m.sideways[0], m.sideways[1], m.sideways[2] / made.lever},
               weight * m.normal_variance);
    for (std::size_t j = 0; j < 3; ++j) gradient[j] -= weight * m.distance * slope[j];
  }
  // Distances larger than the noise of the lines: the twist was not constant. Neighbouring points have the same error
  // then, and count as one of `independent` sectors.
  constexpr double independent = 20.0;
  const auto count = static_cast<double>(matched_);
  const double noise2 = squared(made.noise);
  const double excess = std::max(0.0, noise2 - 2.0 * line_variance / std::max(count, 1.0));
  made.widening = 1.0 + excess * count / (independent * 2.0 * noise2);
  made.of = eigen_of(known);
  for (std::size_t k = 0; k < 3; ++k) {
    const vector_3& direction = made.of.vector[k];
    const double seeming = product(direction, apparent, direction);
    const double real = made.of.value[k] - seeming;
    // Both revolutions have noise.
    const double variance = 2.0 * noise2 * made.of.value[k] / squared(real);
    made.has[k] = real > 2.0 * seeming && variance < squared(known_m_per_s);
    made.variance[k] = made.has[k] ? variance : squared(unknown_m_per_s);
    made.correction[k] = made.has[k] ? dot(direction, gradient) / real : 0.0;
  }
  return made;
}

/// Returns the greatest correction, in standard deviations.
double twist_search::correct(twist_2d& twist, const information& info) noexcept {
  double greatest = 0.0;
  vector_3 sum{};
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t j = 0; j < 3; ++j) sum[j] += info.correction[k] * info.of.vector[k][j];
    greatest = std::max(greatest, std::abs(info.correction[k]) / std::sqrt(info.variance[k]));
  }
  twist.x_m_per_s += sum[0];
  twist.y_m_per_s += sum[1];
  twist.yaw_rad_per_s += sum[2] / info.lever;
  return greatest;
}

bool twist_search::fits(const information& info) const noexcept {
  const auto is_near = [&](const match& m) { return std::abs(m.distance) < 3.0 * info.noise; };
  const auto near = std::ranges::count_if(std::span(matches_).first(matched_), is_near);
  return info.noise < most_noise_m && 3 * static_cast<std::size_t>(near) > 2 * tried_;
}

twist_estimate twist_search::describe(const twist_2d& twist, const information& info) noexcept {
  twist_estimate made{twist, {}, {true, true, true}, twist_status::known};
  const vector_3 unit = {1.0, 1.0, 1.0 / info.lever};
  for (std::size_t k = 0; k < 3; ++k) {
    const vector_3& u = info.of.vector[k];
    const double variance = info.has[k] ? info.variance[k] * info.widening : info.variance[k];
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        made.covariance[3 * i + j] += variance * u[i] * u[j] * unit[i] * unit[j];
    if (variance >= squared(known_m_per_s)) made.status = twist_status::degenerate;
  }
  for (std::size_t i = 0; i < 3; ++i)
    made.known[i] = made.covariance[4 * i] < squared(known_m_per_s * unit[i]) * 3.0;
  return made;
}

}  // namespace g4lidar
