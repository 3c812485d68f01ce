// SPDX-License-Identifier: MIT
#include "g4lidar/export/shaping_writer.hpp"

#include <algorithm>
#include <utility>

#include "g4lidar/deskew.hpp"
#include "g4lidar/wall_clock.hpp"

namespace g4lidar {

shaping_writer::shaping_writer(std::unique_ptr<point_writer> inner, const shaping_options& options)
    : inner_(std::move(inner)),
      options_(options),
      times_(options.time, options.wall_ahead_ns),
      scan_times_(options.time, options.wall_ahead_ns) {
  point_flags& excluded = options_.filter.excluded;
  if (options_.speckle) excluded = excluded | point_flags::isolated;
  if (options_.edges) excluded = excluded | point_flags::veiling;
  if (options_.deskew == deskewing::by_scans) estimator_.emplace();
}

void shaping_writer::begin(text_sink& out) {
  if (!std::exchange(begun_, true)) inner_->begin(out);
}

void shaping_writer::follow_wall_clock() {
  if (!options_.follows_wall_clock) return;
  const std::int64_t ahead_ns = wall_clock().ahead().count();
  times_.set_wall_ahead(ahead_ns);
  scan_times_.set_wall_ahead(ahead_ns);
}

std::span<const point> shaping_writer::in_range(std::span<const point> points) {
  const shaping_options everything;
  const bool has_limits =
      options_.from_ns > everything.from_ns || options_.to_ns < everything.to_ns;
  if (!has_limits || points.empty()) return points;
  if (!first_ns_) first_ns_ = points.front().time_ns;
  const auto find = [&points, first_ns = *first_ns_](auto begin, std::int64_t since_ns) {
    return std::find_if(begin, points.end(),
                        [&](const point& p) { return p.time_ns - first_ns >= since_ns; });
  };
  const auto begin = find(points.begin(), options_.from_ns);
  const auto end = find(begin, options_.to_ns);
  done_ = end != points.end();
  return {begin, end};
}

bool shaping_writer::looks_at_neighbours() const noexcept {
  return options_.speckle.has_value() || options_.edges.has_value();
}

void shaping_writer::mark(std::span<point> points, scan_ends ends) const {
  if (options_.speckle) mark_isolated(points, *options_.speckle, ends);
  if (options_.edges) mark_veiling(points, *options_.edges, ends);
}

std::span<const point> shaping_writer::with_near(std::span<const point> points) {
  if (!options_.near) return points;
  marked_near_.assign(points.begin(), points.end());
  static_cast<void>(mark_near(marked_near_, near_, *options_.near));
  return marked_near_;
}

std::span<const point> shaping_writer::marked_stream(std::span<const point> points, bool is_end) {
  const std::size_t window = std::max(options_.speckle ? options_.speckle->window : 0,
                                      options_.edges ? options_.edges->window : 0);
  const std::size_t old = passed_on_ - std::min(passed_on_, window);
  marked_.erase(marked_.begin(), marked_.begin() + static_cast<std::ptrdiff_t>(old));
  marked_.insert(marked_.end(), points.begin(), points.end());
  mark(marked_, scan_ends::open);
  const std::size_t from = passed_on_ - old;
  const std::size_t waiting = is_end ? 0 : window;
  passed_on_ = std::max(from, marked_.size() - std::min(marked_.size(), waiting));
  return std::span(marked_).subspan(from, passed_on_ - from);
}

void shaping_writer::deskew_scan(std::span<point> points, std::span<const point> whole) {
  const std::int64_t first_ns = whole.front().time_ns;
  if (!estimator_) {
    not_deskewed_ += deskew(points, options_.path, first_ns, options_.mount).outside;
    return;
  }
  const twist_estimate motion = estimator_->add(whole);
  if (motion.is_known() || motion.status == twist_status::degenerate) {
    not_deskewed_ += deskew(points, motion.twist, first_ns).outside;
    return;
  }
  for (point& p : points) p.flags = p.flags | point_flags::not_deskewed;
  not_deskewed_ += points.size();
}

std::span<const point> shaping_writer::shaped(std::span<const point> points) {
  const bool deskews = options_.deskew != deskewing::none;
  const bool is_same = options_.filter.keeps_everything() && times_.changes_nothing() && !deskews;
  if (!options_.for_grid && is_same) return points;
  if (shaped_.size() < points.size()) shaped_.resize(points.size());
  const auto kept = options_.for_grid ? filter_for_grid(points, options_.filter, shaped_)
                                      : filter_points(points, options_.filter, shaped_);
  if (deskews && !points.empty()) deskew_scan(kept, points);
  for (point& p : kept) p.time_ns = times_.of(p.time_ns);
  return kept;
}

void shaping_writer::write_points(std::span<const point> points, text_sink& out) {
  if (done_) return;
  points = with_near(in_range(points));
  if (looks_at_neighbours()) points = marked_stream(points, done_);
  write_shaped(points, out);
}

void shaping_writer::finish(text_sink& out) {
  if (done_ || takes_scans() || !looks_at_neighbours()) return;
  write_shaped(marked_stream({}, true), out);
  done_ = true;
}

void shaping_writer::write_shaped(std::span<const point> points, text_sink& out) {
  if (points.empty()) return;
  begin(out);
  follow_wall_clock();
  times_.come(points.front().time_ns);
  points = shaped(points);
  const std::uint64_t left = options_.count - records_;
  points = points.first(static_cast<std::size_t>(std::min<std::uint64_t>(points.size(), left)));
  inner_->write_points(points, out);
  records_ += points.size();
  done_ = done_ || records_ >= options_.count;
}

void shaping_writer::write_scan(const scan_record& record, text_sink& out) {
  if (done_) return;
  begin(out);
  if (record.scan.is_piece() && !options_.partial_scans) {
    ++pieces_;
    return;
  }
  follow_wall_clock();
  if (in_range(record.scan.points).size() < record.scan.points.size()) return;
  const std::optional<pose_2d> robot = pose_at(options_.path, record.time_ns);
  if (options_.on_path_only && !robot) {
    ++off_path_;
    return;
  }
  times_.come(record.time_ns);
  scan_times_.come(record.time_ns);
  scan_record changed = record;
  changed.scan.points = with_near(record.scan.points);
  if (looks_at_neighbours()) {
    marked_.assign(changed.scan.points.begin(), changed.scan.points.end());
    mark(marked_, record.scan.is_piece() ? scan_ends::open : scan_ends::joined);
    changed.scan.points = marked_;
  }
  if (!inner_->takes_scans()) return write_shaped(changed.scan.points, out);
  changed.scan.points = shaped(changed.scan.points);
  changed.time_ns = scan_times_.of(record.time_ns);
  changed.robot = robot.value_or(record.robot);
  inner_->write_scan(changed, out);
  done_ = ++records_ >= options_.count;
}

}  // namespace g4lidar
