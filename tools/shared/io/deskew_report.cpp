// SPDX-License-Identifier: MIT
#include "deskew_report.hpp"

#include <utility>

#include "cli/logger.hpp"

namespace g4_tool {
namespace {

/// So many scans in sequence decide.
constexpr int scans_that_decide = 5;

}  // namespace

deskew_report::deskew_report(g4lidar::deskewing how, const std::string& where)
    : hint_("points are not deskewed: " +
            (how == g4lidar::deskewing::by_scans
                 ? "the scans do not show the motion"
                 : "there is no odometry " + where + " for the times of the scans")) {}

void deskew_report::add(std::size_t points, std::size_t outside) {
  outside_ += outside;
  const bool is_missing = outside > 0 && outside == points;
  others_ = is_missing == is_missing_ ? 0 : others_ + 1;
  if (others_ < scans_that_decide) return;
  is_missing_ = is_missing;
  others_ = 0;
  logger::info(is_missing ? hint_ + "\n" : "points are deskewed: the motion is known\n");
}

g4lidar::diagnostic_status deskew_report::status() {
  using level = g4lidar::diagnostic_level;
  const std::uint64_t now = outside_;
  const bool is_bad = now > std::exchange(outside_before_, now);
  return {.level = is_bad ? level::warn : level::ok,
          .name = "g4lidar: deskewing",
          .message = is_bad ? hint_ : "ok",
          .values = {{"points_not_deskewed", std::to_string(now)}}};
}

}  // namespace g4_tool
