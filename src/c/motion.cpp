// SPDX-License-Identifier: MIT
// Deskewing, and the twist of a lidar from its scans.
#include <g4lidar/c/motion.h>

#include <cmath>

#include "border.hpp"
#include "g4lidar/deskew.hpp"
#include "g4lidar/twist_estimator.hpp"
#include "motion.hpp"
#include "ranges.hpp"

using namespace g4lidar;
using namespace g4lidar::c;

struct g4lidar_estimator {
  twist_estimator made;
};

namespace {

bool is_usable(double value) noexcept { return std::abs(value) <= max_odometry_value; }
bool is_usable(const g4lidar_twist& twist) noexcept {
  return is_usable(twist.x_m_per_s) && is_usable(twist.y_m_per_s) && is_usable(twist.yaw_rad_per_s);
}

template <class Deskew>
int deskewed_by(const g4lidar_point* points, std::size_t count, const g4lidar_mounting* mount,
                unsigned turn_deg, g4lidar_point* out, std::size_t* outside,
                Deskew deskew_points) noexcept {
  if (count > 0 && (points == nullptr || out == nullptr)) return G4LIDAR_BAD_ARGUMENT;
  if (!is_turn(turn_deg)) return G4LIDAR_BAD_ARGUMENT;
  if (mount != nullptr && (!g4lidar::c::is_usable(mount->pose) || !has_known_members(*mount))) {
    return G4LIDAR_BAD_ARGUMENT;
  }
  const mounting fixed = mount == nullptr ? mounting{} : mounting_of(*mount);
  const deskewed made = deskew_points(points_of(points, count), points_of(out, count), fixed);
  if (outside != nullptr) *outside = made.outside;
  return G4LIDAR_OK;
}

int add_to(g4lidar_estimator* estimator, const g4lidar_point* points, std::size_t count,
           std::uint16_t turn_deg, std::uint16_t shortest_mm,
           g4lidar_twist_estimate* estimate) noexcept {
  if (estimator == nullptr || estimate == nullptr || (count > 0 && points == nullptr)) {
    return G4LIDAR_BAD_ARGUMENT;
  }
  const twist_estimate found = estimator->made.add(points_of(points, count), turn_deg, shortest_mm);
  *estimate = {};
  estimate->twist = {found.twist.x_m_per_s, found.twist.y_m_per_s, found.twist.yaw_rad_per_s};
  std::copy(found.covariance.begin(), found.covariance.end(), estimate->covariance);
  std::copy(found.known.begin(), found.known.end(), estimate->known);
  estimate->status = static_cast<std::int32_t>(found.status);
  return G4LIDAR_OK;
}

}  // namespace

bool g4lidar::c::is_usable(const g4lidar_pose& given) noexcept {
  return ::is_usable(given.x_m) && ::is_usable(given.y_m) && ::is_usable(given.yaw_rad);
}

bool g4lidar::c::is_usable(const g4lidar_odometry& given) noexcept {
  return is_usable(given.pose) && ::is_usable(given.twist);
}

std::optional<std::span<const stamped_pose>> g4lidar::c::path_of(const g4lidar_stamped_pose* path,
                                                                 std::size_t count) noexcept {
  if (path == nullptr && count > 0) return std::nullopt;
  for (std::size_t i = 0; i < count; ++i) {
    const bool ascends = i == 0 || path[i - 1].time_ns <= path[i].time_ns;
    if (!ascends || !is_usable(path[i].pose)) return std::nullopt;
  }
  return std::span(reinterpret_cast<const stamped_pose*>(path), count);
}

int g4lidar_deskew_by_twist(const g4lidar_point* points, size_t count, const g4lidar_twist* twist,
                            int64_t reference_ns, const g4lidar_mounting* mount, unsigned turn_deg,
                            g4lidar_point* out, size_t* outside) {
  if (twist == nullptr || !is_usable(*twist)) return G4LIDAR_BAD_ARGUMENT;
  return deskewed_by(points, count, mount, turn_deg, out, outside,
                     [&](std::span<const point> in, std::span<point> to, const mounting& fixed) {
                       return deskew(in, twist_of(*twist), reference_ns, to, fixed,
                                     static_cast<std::uint16_t>(turn_deg));
                     });
}

int g4lidar_deskew_by_path(const g4lidar_point* points, size_t count,
                           const g4lidar_stamped_pose* path, size_t path_count,
                           int64_t reference_ns, const g4lidar_mounting* mount, unsigned turn_deg,
                           g4lidar_point* out, size_t* outside) {
  const auto poses = path_of(path, path_count);
  if (!poses) return G4LIDAR_BAD_ARGUMENT;
  return deskewed_by(points, count, mount, turn_deg, out, outside,
                     [&](std::span<const point> in, std::span<point> to, const mounting& fixed) {
                       return deskew(in, *poses, reference_ns, to, fixed,
                                     static_cast<std::uint16_t>(turn_deg));
                     });
}

int g4lidar_estimator_create(g4lidar_estimator** estimator, g4lidar_error* error) {
  return created(estimator, error, [&] {
    *estimator = new g4lidar_estimator;
    return succeed(error);
  });
}

int g4lidar_estimator_add(g4lidar_estimator* estimator, const g4lidar_point* points, size_t count,
                          unsigned turn_deg, g4lidar_twist_estimate* estimate) {
  if (!is_turn(turn_deg)) return G4LIDAR_BAD_ARGUMENT;
  return add_to(estimator, points, count, static_cast<std::uint16_t>(turn_deg),
                g4_model.range.min_mm, estimate);
}

int g4lidar_estimator_add_of_model(g4lidar_estimator* estimator, const g4lidar_point* points,
                                   size_t count, const char* model,
                                   g4lidar_twist_estimate* estimate) {
  const g4lidar::model* of = &g4_model;
  if (!take_model(model, of)) return G4LIDAR_BAD_ARGUMENT;
  return add_to(estimator, points, count, of->turn_deg, of->range.min_mm, estimate);
}

void g4lidar_estimator_free(g4lidar_estimator* estimator) { delete estimator; }
