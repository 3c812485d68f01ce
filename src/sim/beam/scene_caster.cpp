// SPDX-License-Identifier: MIT
// For a lidar that moves nothing can be prepared but this: in the frame of the beam (see beam.cpp)
// its points have 0 < x, and y + c x between 0 and k. Walls on one side of that strip are passed
// over at four multiplications for each of their ends. The others are tried in the order of the
// ray_caster, so that its result is the same.
#include "sim/exact.hpp"

#include "g4lidar/sim/ray_caster.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "beam.hpp"
#include "g4lidar/core/angle.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "sim/arithmetic.hpp"

namespace g4lidar::sim {
namespace {

constexpr double strip_slack_m = 1e-6;

wall mirrored_at(const pose& lidar, wall w) noexcept {
  w.y1_m = 2.0 * lidar.y_m - w.y1_m;
  w.y2_m = 2.0 * lidar.y_m - w.y2_m;
  return w;
}

pose zero_pose(const world& scene, bool is_turned) noexcept {
  return is_turned ? cable_pose(scene.mounted_at) : scene.mounted_at;
}

world fixed_world(const world& scene, const pose& zero, bool is_mirrored) {
  world fixed{{}, placed(scene.lidar, zero)};
  if (!scene.path.empty()) return fixed;
  for (const wall& w : scene.walls) {
    fixed.walls.push_back(is_mirrored ? mirrored_at(fixed.lidar, w) : w);
  }
  if (is_mirrored) fixed.lidar.heading_deg = -fixed.lidar.heading_deg;
  return fixed;
}

// How often per second it comes back; 0: it stands.
double rounds_per_s_of(const disc& d) noexcept {
  const double x = d.to_x_m - d.x_m;
  const double y = d.to_y_m - d.y_m;
  const double way = std::sqrt(x * x + y * y);
  return way < 1e-6 ? 0.0 : 0.5 * d.speed_m_per_s / way;
}

}  // namespace

// The beam in the axes of the world.
struct G4LIDAR_HIDDEN scene_caster::way_of_beam {
  pose lidar;
  sin_cos heading;
  bool is_mirrored;
  beam ray;  // in the lidar's frame
  double strip_m;
  double e_x, e_y;
  double u_x, u_y;  // n + c e

  way_of_beam(double first_level_deg, const beam_shape& shape, const pose& viewpoint,
              bool mirrored) noexcept
      : lidar(viewpoint),
        heading(sin_cos_deg(viewpoint.heading_deg)),
        is_mirrored(mirrored),
        ray(beam_at(first_level_deg, shape)),
        strip_m(shape.offset_mm * 1e-3) {
    const double right_x = mirrored ? -heading.sine : heading.sine;
    const double right_y = mirrored ? heading.cosine : -heading.cosine;
    e_x = ray.e_x * heading.cosine + ray.e_y * right_x;
    e_y = ray.e_x * heading.sine + ray.e_y * right_y;
    u_x = ray.e_x * right_x - ray.e_y * heading.cosine + shape.slope * e_x;
    u_y = ray.e_x * right_y - ray.e_y * heading.sine + shape.slope * e_y;
  }

  [[nodiscard]] bool may_meet(const wall& w) const noexcept {
    const double x1 = w.x1_m - lidar.x_m;
    const double y1 = w.y1_m - lidar.y_m;
    const double x2 = w.x2_m - lidar.x_m;
    const double y2 = w.y2_m - lidar.y_m;
    const double along = std::max(e_x * x1 + e_y * y1, e_x * x2 + e_y * y2);
    const double across1 = u_x * x1 + u_y * y1;
    const double across2 = u_x * x2 + u_y * y2;
    return along > -strip_slack_m && std::max(across1, across2) > -strip_slack_m &&
           std::min(across1, across2) < strip_m + strip_slack_m;
  }
  [[nodiscard]] bool may_meet(double x_m, double y_m, double radius_m) const noexcept {
    const double x = x_m - lidar.x_m;
    const double y = y_m - lidar.y_m;
    const double reach = 1.01 * radius_m + strip_slack_m;  // u is 1.0098 long
    const double across = u_x * x + u_y * y;
    return e_x * x + e_y * y > -reach && across > -reach && across < strip_m + reach;
  }

  [[nodiscard]] seen_wall seen(const wall& w, std::uint32_t index) const noexcept {
    if (!is_mirrored) return as_seen(w, lidar, heading, index);
    return as_seen(mirrored_at(lidar, w), lidar, {-heading.sine, heading.cosine}, index);
  }
  [[nodiscard]] seen_disc seen(double x_m, double y_m, double radius_m) const noexcept {
    const double x = x_m - lidar.x_m;
    const double y = y_m - lidar.y_m;
    const double right = 1000.0 * (x * heading.sine - y * heading.cosine);
    return {1000.0 * (x * heading.cosine + y * heading.sine), is_mirrored ? -right : right,
            1000.0 * radius_m};
  }
};

scene_caster::scene_caster(const world& scene, const beam_shape& shape, bool is_turned)
    : shape_(shape),
      path_(scene.path),
      zero_(zero_pose(scene, is_turned)),
      fixed_(placed(scene.lidar, zero_)),
      caster_(fixed_world(scene, zero_, false), shape),
      mirrored_caster_(fixed_world(scene, zero_, true), shape),
      walls_(path_.empty() ? std::vector<wall>{} : scene.walls),
      near_beam_(walls_.size()),
      first_disc_(static_cast<std::uint32_t>(scene.walls.size())) {
  discs_.reserve(scene.discs.size());
  for (const disc& d : scene.discs) discs_.push_back({d, rounds_per_s_of(d)});
}

pose scene_caster::lidar_at(std::int64_t time_ns) const noexcept {
  return path_.empty() ? fixed_ : placed(robot_at(path_, time_ns).at, zero_);
}

std::optional<sighting> scene_caster::cast_at_walls(double first_level_deg,
                                                    const way_of_beam& beam) noexcept {
  if (path_.empty()) {
    return (beam.is_mirrored ? mirrored_caster_ : caster_).cast(first_level_deg);
  }
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < walls_.size(); ++i) {
    if (beam.may_meet(walls_[i])) near_beam_[count++] = beam.seen(walls_[i], i);
  }
  const auto last = near_beam_.begin() + static_cast<std::ptrdiff_t>(count);
  std::sort(near_beam_.begin(), last, is_tried_before);
  wall_search search(first_level_deg, shape_);
  for (auto next = near_beam_.begin(); next != last && search.take(*next);) ++next;
  return search.found();
}

std::optional<sighting> scene_caster::cast(double first_level_deg, const pose& lidar,
                                           std::int64_t time_ns, bool is_mirrored) noexcept {
  if (path_.empty() && discs_.empty()) {
    return (is_mirrored ? mirrored_caster_ : caster_).cast(first_level_deg);
  }
  const way_of_beam way(first_level_deg, shape_, lidar, is_mirrored);
  std::optional<sighting> met = cast_at_walls(first_level_deg, way);
  for (std::uint32_t i = 0; i < discs_.size(); ++i) {
    const auto& [d, rounds_per_s] = discs_[i];
    const double rounds = static_cast<double>(time_ns) * 1e-9 * rounds_per_s;
    const double round = rounds - static_cast<double>(detail::saturated<std::int64_t>(rounds));
    const double part = round < 0.5 ? 2.0 * round : 2.0 - 2.0 * round;
    const double x = d.x_m + part * (d.to_x_m - d.x_m);
    const double y = d.y_m + part * (d.to_y_m - d.y_m);
    if (!way.may_meet(x, y, d.radius_m)) continue;
    const auto range = meet(way.seen(x, y, d.radius_m), way.ray, met ? met->range_mm : 1e9);
    if (!range) continue;
    met = sighting{*range, wrap_once_deg(first_level_deg + correction_deg(*range, shape_)),
                   first_disc_ + i};
  }
  return met;
}

}  // namespace g4lidar::sim
