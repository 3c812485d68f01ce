// SPDX-License-Identifier: MIT
// The points that dump and scan must show, filtered and turned by an independent calculation.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "expected_points.hpp"
#include "program.hpp"
#include "recording.hpp"

namespace cli {

inline constexpr double degrees_of_radian = 180.0 / std::numbers::pi;

// Going from `from` on in the direction in which angles grow, is `angle` met before or at `to`?
inline bool is_within(double angle, double from, double to) {
  if (to - from >= 360.0) return true;
  const double way = std::fmod(angle - from + 1080.0, 360.0);
  const double end = std::fmod(to - from + 1080.0, 360.0);
  return way <= end + 1e-9 || way >= 360.0 - 1e-9;
}

// Whether it is too near to a border for the angles of floats to decide.
inline bool is_doubtful(double angle, double border) {
  return std::abs(std::remainder(angle - border, 360.0)) < 1e-4;
}

inline double robot_deg(double angle_deg) { return std::remainder(180.0 - angle_deg, 360.0); }

inline const std::string& simulated() {
  static const std::string bytes = run({"sim", "--seconds", "2", "--seed", "5"}).out;
  return bytes;
}

// Around both places where angles begin anew, every 64th of a degree, far, near and without return.
inline const std::string& all_around() {
  static const std::string bytes = [] {
    std::string made;
    for (int angle = 0; angle < 360 * 64; angle += 7) {
      made += packet(angle / 64.0, angle / 64.0, {0, 3, 5, 400, 1120, 4000, 64000, 65535});
    }
    return made;
  }();
  return bytes;
}

struct wanted_form {
  double fov_from = -360.0;
  double fov_to = 360.0;
  double ignore_from = 0.0;
  double ignore_to = 0.0;
  bool ignores = false;
  double range_from_mm = -1.0;
  double range_to_mm = 1e9;
};

/// A point that is to be shown, or may be.
struct wanted_point {
  std::uint64_t scan;
  double angle_deg;
  double range_mm;
  std::int64_t time_ns;
  bool is_doubtful;
};

inline std::vector<wanted_point> wanted_points(const std::string& bytes, bool robot,
                                               const wanted_form& wanted) {
  std::vector<wanted_point> points;
  std::size_t index = 0;
  for (const expected_point& p : points_in(bytes)) {
    const std::int64_t time_ns = counted_time_ns(index++);
    const double angle = robot ? robot_deg(p.angle_deg) : p.angle_deg;
    const bool is_kept =
        is_within(angle, wanted.fov_from, wanted.fov_to) &&
        !(wanted.ignores && is_within(angle, wanted.ignore_from, wanted.ignore_to));
    const bool doubtful =
        is_doubtful(angle, wanted.fov_from) || is_doubtful(angle, wanted.fov_to) ||
        is_doubtful(angle, wanted.ignore_from) || is_doubtful(angle, wanted.ignore_to);
    if (p.range_mm < wanted.range_from_mm || p.range_mm > wanted.range_to_mm) continue;
    if (is_kept || doubtful) points.push_back({p.scan, angle, p.range_mm, time_ns, doubtful});
  }
  return points;
}

/// All of them in order, where those that are doubtful may be missing; `unit_mm` is what ranges are counted in.
inline void expect_shown(const std::vector<row>& shown, const std::vector<wanted_point>& wanted,
                         double unit_mm = 1.0) {
  std::size_t at = 0;
  for (const wanted_point& p : wanted) {
    const bool is_here = at < shown.size() && shown[at].time_ns == p.time_ns;
    if (!is_here) {
      ASSERT_TRUE(p.is_doubtful) << p.angle_deg << " degrees at " << p.time_ns << " is missing";
      continue;
    }
    ASSERT_LT(std::abs(std::remainder(shown[at].angle_deg - p.angle_deg, 360.0)), 1e-4);
    ASSERT_NEAR(shown[at].range, p.range_mm / unit_mm, 1e-9);
    ASSERT_EQ(shown[at].scan, p.scan);
    ++at;
  }
  EXPECT_EQ(at, shown.size()) << "a point that is not wanted";
  EXPECT_GT(at, 0U);
}

inline void expect_filtered(const std::vector<std::string>& options, bool robot,
                            const wanted_form& wanted) {
  for (const std::string* const bytes : {&simulated(), &all_around()}) {
    std::vector<std::string> arguments{"dump", "-", "-f", "csv", "-q"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    if (robot) arguments.insert(arguments.end(), {"--frame", "robot"});
    const outcome done = run(arguments, *bytes);
    ASSERT_EQ(done.code, 0) << done.err;
    const std::vector<row> shown = rows_of(done.out);
    expect_shown(shown, wanted_points(*bytes, robot, wanted));
    for (const row& r : shown) {
      ASSERT_TRUE(robot ? r.angle_deg >= -180.0 && r.angle_deg < 180.0
                        : r.angle_deg >= 0.0 && r.angle_deg < 360.0);
    }
  }
}

}  // namespace cli
