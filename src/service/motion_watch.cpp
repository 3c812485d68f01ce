// SPDX-License-Identifier: MIT
#include "service/motion_watch.hpp"

#include <utility>

namespace g4lidar {
namespace {

/// So many scans in sequence decide.
constexpr int scans_that_decide = 5;

}  // namespace

motion_watch::motion_watch(deskewing deskew, const std::string& where)
    : hint_("points are not deskewed: " +
            (deskew == deskewing::by_scans
                 ? "the scans do not show the motion"
                 : "there is no odometry " + where + " for the times of the scans")) {}

std::optional<bool> motion_watch::add(std::size_t points, std::size_t outside) {
  outside_ += outside;
  const bool is_missing = outside > 0 && outside == points;
  others_ = is_missing == is_missing_ ? 0 : others_ + 1;
  if (others_ < scans_that_decide) return std::nullopt;
  is_missing_ = is_missing;
  others_ = 0;
  return !is_missing;
}

diagnostic_status motion_watch::status() {
  const std::uint64_t now = outside_;
  const bool is_bad = now > std::exchange(outside_before_, now);
  return {.level = is_bad ? diagnostic_level::warn : diagnostic_level::ok,
          .name = "g4lidar: deskewing",
          .message = is_bad ? hint_ : "ok",
          .values = {{"points_not_deskewed", std::to_string(now)}}};
}

}  // namespace g4lidar
