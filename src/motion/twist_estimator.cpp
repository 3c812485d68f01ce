// SPDX-License-Identifier: MIT
#include "g4lidar/motion/twist_estimator.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "motion/scan_points.hpp"
#include "motion/twist_search.hpp"

namespace g4lidar {
namespace {

/// Why the two cannot be compared; `known` if they can.
twist_status comparability(const scan_points& before, const scan_points& after) noexcept {
  if (before.why_unusable() == twist_status::first_scan) return twist_status::first_scan;
  if (const auto why = after.why_unusable()) return *why;
  if (const auto why = before.why_unusable()) return *why;
  const std::int64_t gap = after.first_ns() - before.last_ns();
  if (gap <= 0) return twist_status::no_times;
  const std::int64_t longest =
      std::max(after.last_ns() - after.first_ns(), before.last_ns() - before.first_ns());
  return gap > longest / 2 ? twist_status::lost_revolution : twist_status::known;
}

}  // namespace

struct twist_estimator::state {
  std::array<scan_points, 2> scans;
  std::size_t newest = 0;
  twist_search search;
  twist_2d last;
};

twist_estimator::twist_estimator() : state_(std::make_unique<state>()) {}
twist_estimator::twist_estimator(twist_estimator&&) noexcept = default;
twist_estimator& twist_estimator::operator=(twist_estimator&&) noexcept = default;
twist_estimator::~twist_estimator() = default;

twist_estimate twist_estimator::add(std::span<const point> points, std::uint16_t turn_deg,
                                    std::uint16_t shortest_mm) noexcept {
  state& s = *state_;
  const scan_points& before = s.scans[s.newest];
  s.newest = 1 - s.newest;
  scan_points& after = s.scans[s.newest];
  after.load(points, turn_deg, shortest_mm);
  const twist_status why = comparability(before, after);
  const twist_estimate made = why == twist_status::known ? s.search.find(before, after, s.last)
                                                         : unknown_twist(why, s.last);
  s.last = made.twist;
  return made;
}

void twist_estimator::reset() noexcept {
  for (scan_points& scan : state_->scans) scan.clear();
  state_->last = {};
}

}  // namespace g4lidar
