// SPDX-License-Identifier: MIT
// Poses, and the twist of a lidar from its scans.
#include <g4lidar/c/motion.h>

#include <algorithm>
#include <cmath>

#include "border.hpp"
#include "g4lidar/motion/twist_estimator.hpp"
#include "motion_values.hpp"

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

int g4lidar_estimator_create(g4lidar_estimator** estimator, g4lidar_error* error) {
  return created(estimator, error, [&] {
    *estimator = new g4lidar_estimator;
    return succeed(error);
  });
}

int g4lidar_estimator_add_of_model(g4lidar_estimator* estimator, const g4lidar_point* points,
                                   size_t count, const char* model,
                                   g4lidar_twist_estimate* estimate) {
  const g4lidar::model* of = &g4_model;
  if (estimator == nullptr || estimate == nullptr || (count > 0 && points == nullptr) ||
      !take_model(model, of)) {
    return G4LIDAR_BAD_ARGUMENT;
  }
  const twist_estimate found =
      estimator->made.add(points_of(points, count), of->turn_deg, of->range.min_mm);
  *estimate = {};
  estimate->twist = {found.twist.x_m_per_s, found.twist.y_m_per_s, found.twist.yaw_rad_per_s};
  std::copy(found.covariance.begin(), found.covariance.end(), estimate->covariance);
  std::copy(found.known.begin(), found.known.end(), estimate->known);
  estimate->status = static_cast<std::int32_t>(found.status);
  return G4LIDAR_OK;
}

void g4lidar_estimator_free(g4lidar_estimator* estimator) { delete estimator; }
