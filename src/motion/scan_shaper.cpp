// SPDX-License-Identifier: MIT
#include "g4lidar/scan_shaper.hpp"

#include <utility>

#include "g4lidar/motion/deskew.hpp"

namespace g4lidar {

scan_shaper::scan_shaper(const shaping_options& options) { set_options(options); }

void scan_shaper::set_options(const shaping_options& options) {
  std::vector<sector> sectors(options.filter.ignored_sectors.begin(),
                              options.filter.ignored_sectors.end());
  std::vector<std::vector<corner>> corners;
  for (const polygon& each : options.filter.masks) corners.emplace_back(each.begin(), each.end());
  options_ = options;
  sectors_ = std::move(sectors);
  corners_ = std::move(corners);
  masks_.assign(corners_.begin(), corners_.end());
  point_filter& filter = options_.filter;
  filter.ignored_sectors = sectors_;
  filter.masks = masks_;
  if (options_.marks.speckle) filter.excluded = filter.excluded | point_flags::isolated;
  if (options_.marks.edges) filter.excluded = filter.excluded | point_flags::veiling;
  if (!options_.marks.near) near_.reset();
  if (options_.deskew != deskewing::by_scans) estimator_.reset();
  if (options_.deskew == deskewing::by_scans && !estimator_) estimator_.emplace();
}

bool scan_shaper::deskews() const noexcept {
  return options_.deskew != deskewing::none && !options_.for_merging;
}

void scan_shaper::shape(const scan& source, std::span<const stamped_pose> path) {
  source_ = source;
  options_.filter.turn_deg = source.model->turn_deg;
  needs_marks_ = options_.marks.window() > 0;
  path_ = options_.deskew == deskewing::by_path ? path : std::span<const stamped_pose>();
  kept_.points.reset();
  for_grid_.points.reset();
  twist_.reset();
  if (estimator_ && !source.empty()) {
    const twist_estimate motion = estimator_->add(source);
    if (motion.is_known() || motion.status == twist_status::degenerate) twist_ = motion.twist;
  }
  outside_ = count_outside();
  not_deskewed_ += outside_;
  if (!options_.marks.near) return;
  marked_.assign(source_.begin(), source_.end());
  mark_near(marked_, near_, *options_.marks.near, *source.model, source.sample_rate_hz);
  source_.points = marked_;
}

std::size_t scan_shaper::count_outside() const noexcept {
  if (!deskews()) return 0;
  if (!twist_ && !pose_at(path_, source_.time_ns())) return source_.size();
  return static_cast<std::size_t>(std::ranges::count_if(source_, [this](const point& p) {
    const bool is_off_path =
        !twist_ && (p.time_ns < path_.front().time_ns || p.time_ns > path_.back().time_ns);
    return p.time_ns == 0 || is_off_path;
  }));
}

scan scan_shaper::make(product& wanted, filtering* filtered) {
  scan made = source_;
  made.points = points_of(wanted, filtered);
  return made;
}

std::span<const point> scan_shaper::points_of(product& wanted, filtering* filtered) {
  if (wanted.points) return *wanted.points;
  if (needs_marks_) {
    if (!options_.marks.near) marked_.assign(source_.begin(), source_.end());
    options_.marks.mark_by_neighbours(marked_,
                                      source_.is_piece() ? scan_ends::open : scan_ends::joined);
    source_.points = marked_;
    needs_marks_ = false;
  }
  if (options_.filter.keeps_everything() && !deskews())
    return wanted.points.emplace(source_.points);
  if (wanted.memory.size() < source_.size()) wanted.memory.resize(source_.size());
  const std::span<point> made = filtered(source_.points, options_.filter, wanted.memory);
  wanted.points = made;
  if (!deskews()) return made;
  const std::int64_t reference_ns = source_.time_ns();
  if (twist_) {
    deskew(made, *twist_, reference_ns, {}, source_.model->turn_deg);
  } else {  // without a path it flags all of them
    deskew(made, path_, reference_ns, options_.mount, source_.model->turn_deg);
  }
  if (!options_.restamps) return made;
  for (point& p : made) {
    if (!p.is_not_deskewed()) p.time_ns = reference_ns;
  }
  return made;
}

scan scan_shaper::kept() { return make(kept_, &filter_points); }

scan scan_shaper::for_grid() { return make(for_grid_, &filter_for_grid); }

}  // namespace g4lidar
