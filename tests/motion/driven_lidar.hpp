// SPDX-License-Identifier: MIT
// A lidar that is driven through walls and moving discs: each sample is cast from the pose at its time.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "g4lidar/motion.hpp"
#include "g4lidar/point.hpp"

namespace g4lidar::test {

struct wall {
  double ax, ay, bx, by;
};
struct moving_disc {
  double x, y, radius, x_m_per_s, y_m_per_s;
};
struct surroundings {
  std::vector<wall> walls;
  std::vector<moving_disc> discs = {};
};

/// Four walls around the rectangle.
inline void add_box(surroundings& to, double x, double y, double width, double depth) {
  to.walls.push_back({x, y, x + width, y});
  to.walls.push_back({x + width, y, x + width, y + depth});
  to.walls.push_back({x + width, y + depth, x, y + depth});
  to.walls.push_back({x, y + depth, x, y});
}

/// A room of 7 by 5 m with furniture, an oblique wall and a door to a second room.
inline surroundings office() {
  surroundings made{{{-3, -2, 4, -2},
                     {4, -2, 4, 1.8},
                     {4, 1.8, 2.8, 3},
                     {2.8, 3, -3, 3},
                     {-3, 3, -3, 1},
                     {-3, 0, -3, -2}}};
  add_box(made, 2.2, -1.9, 1.4, 0.7);
  add_box(made, -1.8, 2.2, 1.2, 0.6);
  add_box(made, -0.4, -1.6, 0.4, 0.4);
  add_box(made, -7, -2, 4, 6);
  made.walls.push_back({-5, 1.5, -4, 4});
  return made;
}

/// 40 m long, 2.4 m wide, along x, without anything in it; its ends are out of sight.
inline surroundings corridor() {
  return {{{-20, -1.2, 20, -1.2}, {-20, 1.2, 20, 1.2}, {-20, -1.2, -20, 1.2}, {20, -1.2, 20, 1.2}}};
}

/// 24 by 20 m with square pillars every 5 m.
inline surroundings pillars() {
  surroundings made;
  add_box(made, -14, -11, 24, 20);
  for (int x = -12; x <= 8; x += 5)
    for (int y = -10; y <= 6; y += 4) add_box(made, x, y, 0.5, 0.5);
  return made;
}

/// All walls are farther than a G4 can see.
inline surroundings empty_hall() {
  surroundings made;
  add_box(made, -30, -30, 60, 60);
  return made;
}

/// The office with four people who walk.
inline surroundings busy_office() {
  surroundings made = office();
  made.discs = {{1.5, 1.5, 0.25, -0.9, 0.3},
                {-2, -1, 0.2, 0.8, 0.6},
                {1.8, 0.4, 0.25, 0, -1.0},
                {-1.2, 1.4, 0.2, 1.1, 0}};
  return made;
}

/// How it is driven and measures.
struct drive {
  twist_2d twist;
  pose_2d start = {0.3, 0.4, 0.2};
  double frequency_hz = 7.0;
  double rate_hz = 9000.0;  ///< Samples per second.
  double noise_m = 0.007;
  double dropouts = 0.03;
  double outliers = 0.03;
  double yaw_rad_per_s2 = 0.0;   ///< An acceleration, for a lidar that turns on the spot.
  double first_angle_deg = 0.0;  ///< Of the head, at the first sample.
};

/// Where something is.
struct place {
  double x, y;
};

/// The pose after `seconds` of a constant twist from the origin, by the closed form.
inline pose_2d driven(const twist_2d& twist, double seconds) {
  const double a = twist.yaw_rad_per_s * seconds;
  if (std::abs(a) < 1e-9) return {twist.x_m_per_s * seconds, twist.y_m_per_s * seconds, a};
  const double along = std::sin(a) / twist.yaw_rad_per_s;
  const double across = (1.0 - std::cos(a)) / twist.yaw_rad_per_s;
  return {along * twist.x_m_per_s - across * twist.y_m_per_s,
          across * twist.x_m_per_s + along * twist.y_m_per_s, a};
}

/// `at`, given in the frame of `pose`, in the frame in which the pose is given.
inline place moved(const pose_2d& pose, const place& at) {
  const double c = std::cos(pose.yaw_rad);
  const double s = std::sin(pose.yaw_rad);
  return {pose.x_m + c * at.x - s * at.y, pose.y_m + s * at.x + c * at.y};
}

/// A point in the lidar's own frame, from its angle and range.
inline place own_place(const point& p) {
  const double angle = static_cast<double>(p.angle_deg) * std::numbers::pi / 180.0;
  const double range = static_cast<double>(p.range_mm) * 0.001;
  return {-range * std::cos(angle), range * std::sin(angle)};
}

class driven_lidar {
 public:
  driven_lidar(surroundings around, const drive& how, std::uint32_t seed)
      : around_(std::move(around)), how_(how), random_(seed), head_deg_(how.first_angle_deg) {}

  /// The points up to the next pass of the head through 0.
  std::vector<point> revolution() {
    std::vector<point> made;
    truth_.clear();
    while (head_deg_ < 360.0) {
      made.push_back(sample());
      ++samples_;
      head_deg_ += 360.0 * how_.frequency_hz / how_.rate_hz;
    }
    head_deg_ -= 360.0;
    return made;
  }

  /// Where the points of the last revolution are in the world, without noise; those of outliers and dropouts are NaN.
  [[nodiscard]] const std::vector<place>& truth() const { return truth_; }
  /// The pose in the world at a time of a point.
  [[nodiscard]] pose_2d pose_at(std::int64_t time_ns) const {
    return pose_after(static_cast<double>(time_ns - start_ns) * 1e-9);
  }

 private:
  static constexpr std::int64_t start_ns = 5'000'000'000;

  [[nodiscard]] pose_2d pose_after(double seconds) const {
    const pose_2d moved_by = driven(how_.twist, seconds);
    const place at = moved(how_.start, {moved_by.x_m, moved_by.y_m});
    return {at.x, at.y,
            how_.start.yaw_rad + moved_by.yaw_rad + 0.5 * how_.yaw_rad_per_s2 * seconds * seconds};
  }

  point sample() {
    const double seconds = static_cast<double>(samples_) / how_.rate_hz;
    const pose_2d pose = pose_after(seconds);
    // The direction depends on the range (the triangle of laser and camera), thus it is found by iteration.
    double angle_deg = head_deg_ - 8.0;
    double range = 0.0;
    for (int i = 0; i < 3; ++i) {
      range = cast(pose, angle_deg, seconds);
      if (range > 0.0 && i < 2)
        angle_deg =
            head_deg_ + std::atan(21.8 * (155.3 - 1000.0 * range) / (155.3 * 1000.0 * range)) *
                            180.0 / std::numbers::pi;
    }
    point made;
    made.time_ns = start_ns + static_cast<std::int64_t>(seconds * 1e9);
    made.angle_deg = wrapped(angle_deg);
    constexpr double nowhere = std::numeric_limits<double>::quiet_NaN();
    place truth = {nowhere, nowhere};
    const double chance = share();
    if (chance < how_.outliers) {
      made.range_mm = static_cast<float>(200.0 + 8000.0 * share());
    } else if (range == 0.0 || chance < how_.outliers + how_.dropouts) {
      made.flags = point_flags::no_return;
    } else {
      made.range_mm = static_cast<float>(1000.0 * range);
      truth = moved(pose, own_place(made));
      made.range_mm += static_cast<float>(1000.0 * how_.noise_m * normal());
    }
    truth_.push_back(truth);
    return made;
  }

  static float wrapped(double angle_deg) {
    const auto made = static_cast<float>(angle_deg < 0.0 ? angle_deg + 360.0 : angle_deg);
    return made < 360.0F ? made : 0.0F;
  }

  /// The distance to the nearest surface in metres, 0 if none is within 0.1 to 16 m.
  [[nodiscard]] double cast(const pose_2d& pose, double angle_deg, double seconds) const {
    const double bearing = pose.yaw_rad + std::numbers::pi - angle_deg * std::numbers::pi / 180.0;
    const double dx = std::cos(bearing);
    const double dy = std::sin(bearing);
    double nearest = 16.0;
    for (const wall& w : around_.walls) {
      const double ex = w.bx - w.ax;
      const double ey = w.by - w.ay;
      const double cross = dx * ey - dy * ex;
      if (cross == 0.0) continue;
      const double ox = w.ax - pose.x_m;
      const double oy = w.ay - pose.y_m;
      const double range = (ox * ey - oy * ex) / cross;
      const double part = (ox * dy - oy * dx) / cross;
      if (part >= 0.0 && part <= 1.0 && range > 0.0) nearest = std::min(nearest, range);
    }
    for (const moving_disc& d : around_.discs) {
      const double ox = d.x + d.x_m_per_s * seconds - pose.x_m;
      const double oy = d.y + d.y_m_per_s * seconds - pose.y_m;
      const double along = ox * dx + oy * dy;
      const double square = d.radius * d.radius - (ox * ox + oy * oy - along * along);
      if (square > 0.0 && along > std::sqrt(square))
        nearest = std::min(nearest, along - std::sqrt(square));
    }
    return nearest < 16.0 && nearest > 0.1 ? nearest : 0.0;
  }

  double share() { return static_cast<double>(random_()) / 4294967296.0; }
  double normal() {
    return std::sqrt(-2.0 * std::log(1.0 - share())) * std::cos(2.0 * std::numbers::pi * share());
  }

  surroundings around_;
  drive how_;
  std::mt19937 random_;
  double head_deg_;
  std::int64_t samples_ = 0;
  std::vector<place> truth_;
};

}  // namespace g4lidar::test
