// SPDX-License-Identifier: MIT
#include "motion/scan_points.hpp"

#include <algorithm>
#include <cmath>

#include "g4lidar/cartesian.hpp"

namespace g4lidar {
namespace {

constexpr std::int64_t longest_ns = 500'000'000;
constexpr std::size_t fewest_returns = 60;
constexpr float farthest_mm = 60'000.0F;

/// Whether its coordinates can be computed with: a caller may give any bytes.
bool is_usable(const point& p, std::uint16_t shortest_mm) noexcept {
  return p.range_mm >= static_cast<float>(shortest_mm) && p.range_mm < farthest_mm &&
         p.angle_deg >= 0.0F && p.angle_deg < 360.0F;
}

bool times_ascend(std::span<const point> points) noexcept {
  const auto descends = [](const point& a, const point& b) { return a.time_ns > b.time_ns; };
  return points.front().time_ns > 0 &&
         std::adjacent_find(points.begin(), points.end(), descends) == points.end() &&
         points.back().time_ns - points.front().time_ns <= longest_ns &&
         points.back().time_ns > points.front().time_ns;
}

}  // namespace

void scan_points::load(std::span<const point> points, std::uint16_t turn_deg,
                       std::uint16_t shortest_mm) noexcept {
  size_ = 0;
  why_unusable_ = read(points, turn_deg, shortest_mm);
  if (why_unusable_) return;
  drop_isolated();
  if (size_ < fewest_returns) why_unusable_ = twist_status::too_few_returns;
}

std::optional<twist_status> scan_points::read(std::span<const point> points, std::uint16_t turn_deg,
                                              std::uint16_t shortest_mm) noexcept {
  if (points.empty()) return twist_status::too_few_returns;
  if (!times_ascend(points)) return twist_status::no_times;
  first_ns_ = points.front().time_ns;
  last_ns_ = points.back().time_ns;
  profile_.fill(0);
  const auto returns = static_cast<std::size_t>(std::ranges::count_if(
      points, [shortest_mm](const point& p) { return is_usable(p, shortest_mm); }));
  const std::size_t step = (returns + most_returns - 1) / most_returns;
  std::size_t index = 0;
  for (const point& p : points) {
    if (!is_usable(p, shortest_mm)) continue;
    if (index++ % step != 0) continue;
    const xy_point at = to_xy(p, frame::robot, turn_deg);
    own_.x[size_] = static_cast<double>(at.x_m);
    own_.y[size_] = static_cast<double>(at.y_m);
    seconds_[size_] = static_cast<double>(p.time_ns - first_ns_) * 1e-9;
    ++size_;
    const float bearing = bearing_deg(p.angle_deg, frame::robot, turn_deg);
    profile_[std::min(directions - 1, static_cast<std::size_t>(bearing))] =
        static_cast<std::int32_t>(p.range_mm);
  }
  return std::nullopt;
}

void scan_points::drop_isolated() noexcept {
  const auto are_near = [&](std::size_t a, std::size_t b) {
    const double distance = std::hypot(own_.x[a] - own_.x[b], own_.y[a] - own_.y[b]);
    return distance < 0.1 + 0.05 * std::hypot(own_.x[b], own_.y[b]);
  };
  std::size_t kept = 0;
  bool is_near_last = false;
  for (std::size_t i = 0; i < size_; ++i) {
    const bool is_near_next = i + 1 < size_ && are_near(i, i + 1);
    if (is_near_last || is_near_next) {
      own_.x[kept] = own_.x[i];
      own_.y[kept] = own_.y[i];
      seconds_[kept] = seconds_[i];
      ++kept;
    }
    is_near_last = is_near_next;
  }
  size_ = kept;
}

void scan_points::place(const twist_2d& twist, std::int64_t time_ns,
                        positions& out) const noexcept {
  // moved_by() for each point, with series for angles below 1.5 radians.
  const double offset = static_cast<double>(first_ns_ - time_ns) * 1e-9;
  for (std::size_t i = 0; i < size_; ++i) {
    const double t = offset + seconds_[i];
    const double a = twist.yaw_rad_per_s * t;
    const double a2 = a * a;
    // sin(a) / a and (1 - cos(a)) / a^2
    const double along =
        1.0 -
        a2 / 6.0 * (1.0 - a2 / 20.0 * (1.0 - a2 / 42.0 * (1.0 - a2 / 72.0 * (1.0 - a2 / 110.0))));
    const double bend =
        0.5 *
        (1.0 - a2 / 12.0 *
                   (1.0 - a2 / 30.0 * (1.0 - a2 / 56.0 * (1.0 - a2 / 90.0 * (1.0 - a2 / 132.0)))));
    const double sine = a * along;
    const double cosine = 1.0 - a2 * bend;
    const double across = a * bend;
    const double x = twist.x_m_per_s * t;
    const double y = twist.y_m_per_s * t;
    out.x[i] = cosine * own_.x[i] - sine * own_.y[i] + along * x - across * y;
    out.y[i] = sine * own_.x[i] + cosine * own_.y[i] + across * x + along * y;
  }
}

}  // namespace g4lidar
