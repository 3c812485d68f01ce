// SPDX-License-Identifier: MIT
// A command becomes a motion with constant acceleration, constant speed, and constant deceleration.
// Forwards and in a turn that is a polynomial of degree 2 in each phase, which the cubic pieces of a
// path are exactly. An arc is divided into pieces of about 2.5 degrees or less.
#include "sim/exact.hpp"

#include "route.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <utility>

#include "sim/arithmetic.hpp"
#include "world_text.hpp"

namespace g4lidar::sim {
namespace {

constexpr double acceleration_m_per_s2 = 1.0;
constexpr double acceleration_deg_per_s2 = 180.0;
constexpr double default_speed_m_per_s = 0.5;
constexpr double default_turn_deg_per_s = 45.0;
constexpr double degrees_of_radian = 180.0 / std::numbers::pi;

std::int64_t as_ns(double seconds) noexcept {
  return static_cast<std::int64_t>(seconds * 1e9 + 0.5);
}

// A way in one direction, from rest to rest.
struct ride {
  double way;
  double speed;
  std::int64_t ramp_ns;
  std::int64_t cruise_ns;

  ride(double whole_way, double top_speed, double acceleration) noexcept : way(whole_way) {
    const double peak = std::min(top_speed, std::sqrt(whole_way * acceleration));
    ramp_ns = as_ns(peak / acceleration);
    cruise_ns = std::max(as_ns(whole_way / peak) - ramp_ns, std::int64_t{0});
    speed = whole_way / (static_cast<double>(ramp_ns + cruise_ns) * 1e-9);
  }

  struct progress {
    double way;
    double speed;
  };
  [[nodiscard]] progress at(std::int64_t ns) const noexcept {
    const double ramp_s = static_cast<double>(ramp_ns) * 1e-9;
    const std::int64_t whole_ns = 2 * ramp_ns + cruise_ns;
    const auto ramp = [&](std::int64_t part_ns) {
      const double s = static_cast<double>(part_ns) * 1e-9;
      return progress{0.5 * speed * s * s / ramp_s, speed * s / ramp_s};
    };
    if (ns <= ramp_ns) return ramp(ns);
    if (ns >= ramp_ns + cruise_ns) {
      const progress rest = ramp(whole_ns - ns);
      return {way - rest.way, rest.speed};
    }
    return {speed * (static_cast<double>(ns) * 1e-9 - 0.5 * ramp_s), speed};
  }
};

// Adds the points of a ride, each phase in one piece or divided into pieces that are at most that
// long on average; a curve needs some of them, because the first one begins at rest. `placed_at`
// gives the pose at a progress.
template <class Place>
void add_ride(std::vector<path_point>& path, const ride& all, std::optional<double> piece,
              const Place& placed_at) {
  const std::int64_t begin_ns = path.back().time_ns;
  const std::array<std::int64_t, 4> edges{0, all.ramp_ns, all.ramp_ns + all.cruise_ns,
                                          2 * all.ramp_ns + all.cruise_ns};
  for (std::size_t phase = 0; phase < 3; ++phase) {
    const std::int64_t length_ns = edges[phase + 1] - edges[phase];
    if (length_ns == 0) continue;
    const double way = all.at(edges[phase + 1]).way - all.at(edges[phase]).way;
    const std::int64_t pieces = piece ? static_cast<std::int64_t>(way / *piece) + 8 : 1;
    for (std::int64_t i = 1; i <= pieces; ++i) {
      const std::int64_t at_ns = edges[phase] + length_ns * i / pieces;
      path.push_back({begin_ns + at_ns, placed_at(all.at(at_ns))});
    }
  }
}

}  // namespace

std::optional<route::error_if_any> route::take(std::string_view word, std::string_view rest,
                                               std::size_t line_number) {
  const bool is_pose = word == "pose";
  if (!is_pose && word != "drive") return std::nullopt;
  if (is_pose ? !legs_.empty() : !path_.empty()) {
    return error_if_any("a path has lines 'pose' or lines 'drive', not both");
  }
  if (path_.size() + legs_.size() == max_path_points) {
    return error_if_any("the path has more than 100000 points");
  }
  return is_pose ? take_pose(rest) : take_drive(rest, line_number);
}

route::error_if_any route::take_pose(std::string_view rest) {
  std::array<double, 4> at{};
  if (auto wrong = numbers(rest, at, "pose time x y heading_deg")) return wrong;
  if (at[0] < 0.0 || at[0] > 1e6) return "the time must be 0 to 1000000 s";
  if (too_far(std::span(at).subspan(1, 2))) return too_far_message;
  if (std::fabs(at[3]) > 360.0) return heading_message;
  path_point next{as_ns(at[0]), {{at[1], at[2], at[3]}, {}}};
  if (!path_.empty()) {
    const path_point& last = path_.back();
    if (next.time_ns <= last.time_ns) return "the time is not later than that of the pose before";
    pose& here = next.robot.at;
    const pose& there = last.robot.at;
    const double turn = here.heading_deg - there.heading_deg;
    const auto turns = static_cast<std::int64_t>(turn / 360.0 + (turn < 0.0 ? -0.5 : 0.5));
    const double shorter = turn - 360.0 * static_cast<double>(turns);
    here.heading_deg = there.heading_deg + shorter;
    const double seconds = static_cast<double>(next.time_ns - last.time_ns) * 1e-9;
    const double x = here.x_m - there.x_m;
    const double y = here.y_m - there.y_m;
    if (std::sqrt(x * x + y * y) > max_speed_m_per_s * seconds) {
      return "the robot would move at more than 20 m/s from the pose before";
    }
    if (std::fabs(shorter) > max_turn_deg_per_s * seconds) {
      return "the robot would turn at more than 1000 degrees per second from the pose before";
    }
  }
  path_.push_back(next);
  return std::nullopt;
}

route::error_if_any route::take_drive(std::string_view rest, std::size_t line_number) {
  struct form {
    std::string_view name;
    std::string_view whole;
    std::size_t least;  // numbers
    std::size_t most;
  };
  static constexpr std::array<form, 4> forms{
      {{"forward", "drive forward metres [metres_per_s]", 1, 2},
       {"turn", "drive turn degrees [degrees_per_s]", 1, 2},
       {"arc", "drive arc radius degrees [metres_per_s]", 2, 3},
       {"wait", "drive wait seconds", 1, 1}}};
  const std::string_view name = next_word(rest);
  const auto found =
      std::find_if(forms.begin(), forms.end(), [&](const form& each) { return each.name == name; });
  if (found == forms.end()) {
    return quoted(name) + " is unknown; commands are 'forward', 'turn', 'arc' and 'wait'";
  }
  std::array<double, 3> at{};
  const auto read =
      read_numbers(rest, std::span(at).first(found->most), found->least, found->whole);
  if (read.wrong) return read.wrong;
  const bool has_speed = read.count > found->least;
  const auto what = static_cast<action>(found - forms.begin());
  const bool is_turn = what == action::turn;
  const double amount = what == action::arc ? at[1] : at[0];
  const double speed =
      has_speed ? at[found->least] : (is_turn ? default_turn_deg_per_s : default_speed_m_per_s);
  const double size = std::fabs(amount);
  if (what == action::wait) {
    if (!(amount >= 0.001 && amount <= 1e5)) return "a wait must be 0.001 to 100000 s";
  } else if (what == action::forward) {
    if (!(size >= 0.001 && size <= 2000.0)) return "a way must be 0.001 to 2000 m, or back";
  } else if (!(size >= 0.1 && size <= 3600.0)) {
    return "a turn must be 0.1 to 3600 degrees, to either side";
  }
  if (what == action::arc && !(at[0] >= 0.05 && at[0] <= 100.0)) {
    return "the radius must be 0.05 to 100 m";
  }
  if (is_turn && !(speed >= 1.0 && speed <= max_turn_deg_per_s)) {
    return "a robot turns at 1 to 1000 degrees per second";
  }
  if (!is_turn && !(speed >= 0.01 && speed <= max_speed_m_per_s)) {
    return "a robot moves at 0.01 to 20 m/s";
  }
  if (what == action::arc && speed / at[0] * degrees_of_radian > max_turn_deg_per_s) {
    return "the robot would turn at more than 1000 degrees per second";
  }
  legs_.push_back({what, amount, at[0], speed, line_number});
  return std::nullopt;
}

void route::follow(const leg& next) {
  const path_point from = path_.back();
  const pose& start = from.robot.at;
  const double size = std::fabs(next.amount);
  const double side = next.amount < 0.0 ? -1.0 : 1.0;
  if (next.what == action::wait) {
    path_.push_back({from.time_ns + as_ns(next.amount), {start, {}}});
  } else if (next.what == action::turn) {
    const ride turning(size, next.speed, acceleration_deg_per_s2);
    add_ride(path_, turning, std::nullopt, [&](const ride::progress& now) {
      return moving_pose{{start.x_m, start.y_m, start.heading_deg + side * now.way},
                         {0.0, 0.0, side * now.speed}};
    });
  } else if (next.what == action::forward) {
    const sin_cos ahead = sin_cos_deg(start.heading_deg);
    const ride straight(size, next.speed, acceleration_m_per_s2);
    add_ride(path_, straight, std::nullopt, [&](const ride::progress& now) {
      const double way = side * now.way;
      const double speed = side * now.speed;
      return moving_pose{
          {start.x_m + ahead.cosine * way, start.y_m + ahead.sine * way, start.heading_deg},
          {ahead.cosine * speed, ahead.sine * speed, 0.0}};
    });
  } else {
    // The centre is to the left for a turn to the left.
    const double radius = side * next.radius_m;
    const sin_cos first = sin_cos_deg(start.heading_deg);
    const ride round(size / degrees_of_radian * next.radius_m, next.speed, acceleration_m_per_s2);
    constexpr double piece_rad = 2.5 / degrees_of_radian;
    add_ride(path_, round, piece_rad * next.radius_m, [&](const ride::progress& now) {
      const double turn = now.way / radius * degrees_of_radian;
      const sin_cos ahead = sin_cos_deg(start.heading_deg + turn);
      return moving_pose{
          {start.x_m + radius * (ahead.sine - first.sine),
           start.y_m - radius * (ahead.cosine - first.cosine), start.heading_deg + turn},
          {ahead.cosine * now.speed, ahead.sine * now.speed,
           now.speed / radius * degrees_of_radian}};
    });
  }
}

std::optional<world_error> route::finish(const pose& start) {
  if (legs_.empty()) {
    smooth(path_);
    return std::nullopt;
  }
  path_.push_back({0, {start, {}}});
  for (const leg& each : legs_) {
    follow(each);
    const path_point& end = path_.back();
    if (too_far(std::array{end.robot.at.x_m, end.robot.at.y_m})) {
      return world_error{each.line,
                         "the robot would leave the world: " + std::string(too_far_message)};
    }
    if (end.time_ns > max_path_ns)
      return world_error{each.line, "the path takes more than 1000000 s"};
    if (path_.size() > max_path_points) {
      return world_error{each.line, "the path has more than 100000 points"};
    }
  }
  return std::nullopt;
}

}  // namespace g4lidar::sim
