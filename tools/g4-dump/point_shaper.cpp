// SPDX-License-Identifier: MIT
#include "point_shaper.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "g4lidar/angle.hpp"

namespace g4_dump {
namespace {

/// More than --range can ask for: it was not given.
constexpr double longest_m = 100.0;

/// Metres of a command line in millimetres, to the nearest thousandth, so that 0.28 is 280.
double in_mm(double metres) { return std::round(metres * 1e6) / 1e3; }

}  // namespace

sector::sector(number_range degrees) noexcept
    : everything_(degrees.to - degrees.from >= 360.0),
      from_(everything_ ? 0.0 : g4lidar::wrap_deg(degrees.from)),
      to_(everything_ ? 360.0 : g4lidar::wrap_deg(degrees.to)),
      wraps_(from_ > to_) {}

void time_shift::set_wall_ahead(std::int64_t wall_ahead_ns) noexcept {
  constexpr std::int64_t step_ns = 1'000'000;  // less is the time between two looks at clocks
  if (style_ != time_style::absolute || std::abs(wall_ahead_ns - shift_ns_) < step_ns) return;
  shift_ns_ = wall_ahead_ns;
}

point_shaper::point_shaper(const common_options& options, purpose what)
    : purpose_(what),
      frame_(options.frame),
      range_mm_{in_mm(options.range_m.from), in_mm(options.range_m.to)},
      all_ranges_(options.range_m.to > longest_m),
      all_directions_(false),
      fov_(options.fov_deg) {
  for (const number_range& degrees : options.ignore_deg) ignored_.emplace_back(degrees);
  all_directions_ = fov_.is_everything() && ignored_.empty();
}

bool point_shaper::has_direction(double degrees) const noexcept {
  if (!fov_.has(degrees)) return false;
  return std::none_of(ignored_.begin(), ignored_.end(),
                      [degrees](const sector& post) { return post.has(degrees); });
}

template <g4lidar::frame Frame>
std::size_t point_shaper::shape_into(std::span<const g4lidar::point> points) {
  g4lidar::point* at = shaped_.data();
  for (const g4lidar::point& p : points) {
    const float degrees = Frame == g4lidar::frame::vendor
                              ? p.angle_deg
                              : g4lidar::bearing_deg(g4lidar::direction_deg(p), Frame);
    *at = p;
    at->angle_deg = degrees;
    const bool kept = (all_directions_ || has_direction(static_cast<double>(degrees))) &&
                      (all_ranges_ || has_range(p.range_mm));
    at += kept ? 1 : 0;
  }
  return static_cast<std::size_t>(at - shaped_.data());
}

std::size_t point_shaper::shape_for_grid(std::span<const g4lidar::point> points) {
  using enum g4lidar::point_marks;
  std::size_t count = 0;
  for (const g4lidar::point& p : points) {
    const float direction = g4lidar::direction_deg(p);
    if (!has_direction(static_cast<double>(g4lidar::bearing_deg(direction, frame_)))) continue;
    g4lidar::point& kept = shaped_[count++] = p;
    if (p.is_no_return() || all_ranges_) continue;
    kept.marks = (p.marks & revolution_start) | (has_range(p.range_mm) ? none : too_near);
  }
  return count;
}

std::span<g4lidar::point> point_shaper::shape(std::span<const g4lidar::point> points) {
  if (shaped_.size() < points.size()) shaped_.resize(points.size());
  std::size_t count = 0;
  if (purpose_ == purpose::grid) {
    count = shape_for_grid(points);
  } else if (frame_ == g4lidar::frame::robot) {
    count = shape_into<g4lidar::frame::robot>(points);
  } else {
    count = shape_into<g4lidar::frame::vendor>(points);
  }
  return std::span(shaped_).first(count);
}

}  // namespace g4_dump
