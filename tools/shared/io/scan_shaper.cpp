// SPDX-License-Identifier: MIT
#include "scan_shaper.hpp"

#include <utility>

#include "g4lidar/deskew.hpp"
#include "g4lidar/outliers.hpp"
#include "io/mask_file.hpp"

namespace g4_tool {
namespace {

constexpr std::int64_t kept_path_ns = 5'000'000'000;
/// So long a robot is taken to keep its velocity.
constexpr std::int64_t longest_guess_ns = 200'000'000;

}  // namespace

void odometry_path::add(const stamped_odometry& now) {
  if (std::exchange(is_last_guessed_, false)) poses_.pop_back();
  if (newest_ && now.time_ns <= newest_->time_ns) poses_.clear();
  newest_ = now;
  std::erase_if(
      poses_, [&now](const stamped_pose& old) { return old.time_ns < now.time_ns - kept_path_ns; });
  poses_.push_back({now.time_ns, now.pose});
}

std::span<const stamped_pose> odometry_path::until(std::int64_t time_ns) {
  if (std::exchange(is_last_guessed_, false)) poses_.pop_back();
  if (newest_ && newest_->time_ns < time_ns && time_ns - newest_->time_ns <= longest_guess_ns) {
    const double seconds = static_cast<double>(time_ns - newest_->time_ns) * 1e-9;
    poses_.push_back({time_ns, newest_->pose * moved_by(newest_->twist, seconds)});
    is_last_guessed_ = true;
  }
  return poses_;
}

scan_shaper::scan_shaper(const common_options& how, const mounting& mount) : mount_(mount) {
  set_filters(how);
  if (how_.deskew == deskewing::by_scans) estimator_.emplace();
}

void scan_shaper::set_filters(const common_options& how) {
  if (!how.mask.empty() && how.mask != how_.mask) mask_ = load_mask(how.mask);
  how_ = how;
  filter_ = how_.filter;
  filter_.in = how_.frame;
  filter_.ignored_sectors = how_.ignored;
  filter_.masks = mask_.polygons();
  if (how_.marks.speckle) filter_.excluded = filter_.excluded | point_flags::isolated;
  if (how_.marks.edges) filter_.excluded = filter_.excluded | point_flags::veiling;
}

shaped_scan scan_shaper::shape(const scan& whole, std::span<const stamped_pose> path) {
  std::span<const point> points = whole.points;
  if (how_.marks.speckle || how_.marks.edges || how_.marks.near) {
    marked_.assign(points.begin(), points.end());
    if (how_.marks.near) mark_near(marked_, near_, *how_.marks.near);
    if (how_.marks.speckle) mark_isolated(marked_, *how_.marks.speckle, scan_ends::joined);
    if (how_.marks.edges) mark_veiling(marked_, *how_.marks.edges, scan_ends::joined);
    points = marked_;
  }
  if (filter_.keeps_everything() && how_.deskew == deskewing::none)
    return {points, points, {}, how_.grid};
  for_grid_.resize(points.size());
  kept_.resize(points.size());
  const std::span<point> for_grid = filter_for_grid(points, filter_, for_grid_);
  const std::span<point> kept = filter_points(points, filter_, kept_);
  if (how_.deskew == deskewing::none) return {for_grid, kept, {}, how_.grid};
  std::optional<twist_2d> twist;
  if (estimator_) {
    const twist_estimate motion = estimator_->add(whole.points);
    if (motion.is_known() || motion.status == twist_status::degenerate) twist = motion.twist;
  }
  const std::int64_t reference_ns = whole.time_ns();
  static_cast<void>(deskewed_points(for_grid, reference_ns, path, twist));
  for (point& p : deskewed_points(kept, reference_ns, path, twist)) {
    const bool is_outside = (p.flags & point_flags::not_deskewed) != point_flags::none;
    if (!is_outside) p.time_ns = reference_ns;
    not_deskewed_ += is_outside ? 1 : 0;
  }
  return {for_grid, kept, twist, how_.grid};
}

std::span<point> scan_shaper::deskewed_points(std::span<point> points, std::int64_t reference_ns,
                                              std::span<const stamped_pose> path,
                                              const std::optional<twist_2d>& twist) {
  if (twist) return deskew(points, *twist, reference_ns).points;
  return deskew(points, path, reference_ns, mount_).points;
}

}  // namespace g4_tool
