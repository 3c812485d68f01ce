// SPDX-License-Identifier: MIT
// Between two samples the robot moves along a chord, in the direction that is the mean of both
// headings turned by a constant. Without errors the chords add up to the true path exactly.
#include "sim/exact.hpp"

#include "g4lidar/sim/odometry.hpp"

#include <cassert>
#include <cmath>
#include <numbers>

#include "g4lidar/detail/saturating.hpp"
#include "sim/arithmetic.hpp"
#include "sim/purpose.hpp"

namespace g4lidar::sim {
namespace {

constexpr double radians_of_degree = std::numbers::pi / 180.0;

bool is_within(double x, double least, double most) noexcept { return x >= least && x <= most; }

double wrapped_rad(double degrees) noexcept {
  const auto turns =
      detail::saturated<std::int64_t>(degrees / 360.0 + (degrees < 0.0 ? -0.5 : 0.5));
  return (degrees - 360.0 * static_cast<double>(turns)) * radians_of_degree;
}

// The error of a measured length, in parts of it; `unit` long ones have the standard deviation
// `noise`. One random number in any case.
double relative_error(random_stream& random, double noise, double length, double unit) noexcept {
  const double error = random.gaussian();
  return length > 0.0 ? error * noise * std::sqrt(unit / length) : 0.0;
}

}  // namespace

std::string_view problem_with(const odometry_options& options) noexcept {
  if (!is_within(options.rate_hz, 0.1, 1000.0)) return "the odometry's rate must be 0.1 to 1000 Hz";
  if (!is_within(options.way_noise, 0.0, 1.0) || !is_within(options.turn_noise, 0.0, 1.0)) {
    return "the odometry's noise must be 0 to 1 of a way of 1 m, and of a turn by 90 degrees";
  }
  if (!is_within(options.way_slip, -0.5, 0.5) || !is_within(options.turn_slip, -0.5, 0.5)) {
    return "the odometry's slip must be -0.5 to 0.5";
  }
  return {};
}

odometry::odometry(const world& scene, const odometry_options& options)
    : options_(options),
      path_(scene.path),
      way_noise_(stream_for(options.seed, purpose::odometry_way)),
      turn_noise_(stream_for(options.seed, purpose::odometry_turn)) {
  assert(problem_with(options).empty());
  if (path_.empty()) path_.push_back({0, {scene.lidar, {}}});
  truth_ = robot_at(path_, 0).at;
}

std::int64_t odometry::next_ns() const noexcept {
  return detail::saturated<std::int64_t>(static_cast<double>(index_) * (1e9 / options_.rate_hz) +
                                         0.5);
}

odometry_sample odometry::next() noexcept {
  const std::int64_t now_ns = next_ns();
  const pose now = robot_at(path_, now_ns).at;
  const double x = now.x_m - truth_.x_m;
  const double y = now.y_m - truth_.y_m;
  const double turn = now.heading_deg - truth_.heading_deg;
  const double way_error =
      relative_error(way_noise_, options_.way_noise, std::sqrt(x * x + y * y), 1.0);
  const double turn_error = relative_error(turn_noise_, options_.turn_noise, std::fabs(turn), 90.0);

  // In the frame of the robot, halfway.
  const sin_cos true_heading = sin_cos_deg(truth_.heading_deg + 0.5 * turn);
  const double scale = 1.0 + options_.way_slip + way_error;
  const double ahead = scale * (true_heading.cosine * x + true_heading.sine * y);
  const double left = scale * (true_heading.cosine * y - true_heading.sine * x);
  const double counted_turn = turn * (1.0 + options_.turn_slip + turn_error);
  const sin_cos heading = sin_cos_deg(believed_.heading_deg + 0.5 * counted_turn);
  believed_.x_m += heading.cosine * ahead - heading.sine * left;
  believed_.y_m += heading.sine * ahead + heading.cosine * left;
  believed_.heading_deg += counted_turn;
  truth_ = now;

  const double rate = index_++ == 0 ? 0.0 : options_.rate_hz;
  return {now_ns,
          believed_.x_m,
          believed_.y_m,
          wrapped_rad(believed_.heading_deg),
          ahead * rate,
          left * rate,
          counted_turn * radians_of_degree * rate};
}

}  // namespace g4lidar::sim
