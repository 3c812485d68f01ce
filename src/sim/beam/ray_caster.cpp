// SPDX-License-Identifier: MIT
// Sectors of half a degree select the walls that a beam can hit.
#include "sim/exact.hpp"

#include "g4lidar/sim/ray_caster.hpp"

#include <algorithm>
#include <cstddef>

#include "beam.hpp"
#include "g4lidar/core/angle.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "sim/arithmetic.hpp"

namespace g4lidar::sim {
namespace {

constexpr std::size_t sectors = 720;

}  // namespace

ray_caster::ray_caster(const world& scene, const beam_shape& shape) : shape_(shape) {
  const sin_cos heading = sin_cos_deg(scene.lidar.heading_deg);
  walls_.reserve(scene.walls.size());
  for (const wall& w : scene.walls) {
    walls_.push_back(as_seen(w, scene.lidar, heading, static_cast<std::uint32_t>(walls_.size())));
  }
  // The index makes the order of all walls the same with every standard library.
  std::sort(walls_.begin(), walls_.end(), is_tried_before);

  // A wall between the bearings b1 and b2, with points between the ranges d1 and d2, is hit from
  // first-level angles between b1 - correction(d1) and b2 - correction(d2) only.
  std::vector<std::vector<std::uint32_t>> seen_from(sectors);
  for (std::uint32_t i = 0; i < walls_.size(); ++i) {
    const seen_wall& w = walls_[i];
    const auto bearing_at = [&w](double along) {
      return atan2_deg(w.normal_y * w.distance + w.tangent_y * along,
                       w.normal_x * w.distance + w.tangent_x * along);
    };
    double first = bearing_at(w.along_begin);
    double width = wrap_once_deg(bearing_at(w.along_end) - first);
    if (width > 180.0) {
      first = wrap_once_deg(first + width);
      width = 360.0 - width;
    }
    constexpr double margin = 0.01;
    const double begin =
        first - correction_deg(std::max(w.nearest, least_range_mm), shape_) - margin;
    const double end = first + width - correction_deg(w.farthest, shape_) + margin;
    constexpr double per_degree = static_cast<double>(sectors) / 360.0;
    const bool all_round = w.distance < least_range_mm || end - begin >= 359.0;
    const auto from = detail::saturated<std::size_t>((begin + 360.0) * per_degree);
    const auto to =
        all_round ? from + sectors - 1 : detail::saturated<std::size_t>((end + 360.0) * per_degree);
    for (std::size_t s = from; s <= to; ++s) seen_from[s % sectors].push_back(i);
  }
  sector_begin_.reserve(sectors + 1);
  for (const std::vector<std::uint32_t>& sector : seen_from) {
    sector_begin_.push_back(static_cast<std::uint32_t>(candidates_.size()));
    candidates_.insert(candidates_.end(), sector.begin(), sector.end());
  }
  sector_begin_.push_back(static_cast<std::uint32_t>(candidates_.size()));
}

std::optional<sighting> ray_caster::cast(double first_level_deg) const noexcept {
  constexpr double per_degree = static_cast<double>(sectors) / 360.0;
  const std::size_t sector =
      std::min(detail::saturated<std::size_t>(first_level_deg * per_degree), sectors - 1);
  wall_search search(first_level_deg, shape_);
  for (std::uint32_t i = sector_begin_[sector]; i < sector_begin_[sector + 1]; ++i) {
    if (!search.take(walls_[candidates_[i]])) break;
  }
  return search.found();
}

}  // namespace g4lidar::sim
