// SPDX-License-Identifier: MIT
#include "shaping_writer.hpp"

#include <algorithm>
#include <utility>

#include "g4lidar/core/wall_clock.hpp"
#include "g4lidar/filter.hpp"
#include "io/far_times.hpp"

namespace g4_tool {
namespace {

shaping_options shape_of(const writing_options& options) {
  shaping_options made = options.shape;
  made.filter.turn_deg = options.model->turn_deg;
  return made;
}

}  // namespace

shaping_writer::shaping_writer(std::unique_ptr<point_writer> inner, const writing_options& options)
    : inner_(std::move(inner)),
      options_(options),
      shaper_(shape_of(options)),
      spacing_(*options.model),
      times_(options.time, options.wall_ahead_ns),
      scan_times_(options.time, options.wall_ahead_ns) {
  options_.shape.filter = {};  // the shaper has it, with a copy of what it views
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
  const writing_options everything;
  const bool has_limits =
      options_.from_ns > everything.from_ns || options_.to_ns < everything.to_ns;
  if (!has_limits || points.empty()) return points;
  if (!first_ns_) first_ns_ = points.front().time_ns;
  const auto find = [&points, first_ns = *first_ns_](auto begin, std::int64_t since_ns) {
    return std::find_if(begin, points.end(),
                        [&](const point& p) { return way_ns(first_ns, p.time_ns) >= since_ns; });
  };
  const auto begin = find(points.begin(), options_.from_ns);
  const auto end = find(begin, options_.to_ns);
  done_ = end != points.end();
  return {begin, end};
}

std::span<const point> shaping_writer::marked_stream(std::span<const point> points, bool is_end) {
  mark_limits marks = options_.shape.marks;
  const std::size_t window = marks.window();
  if (window == 0 && !marks.near) return points;
  const std::size_t old = passed_on_ - std::min(passed_on_, window);
  stream_.erase(stream_.begin(), stream_.begin() + static_cast<std::ptrdiff_t>(old));
  stream_.insert(stream_.end(), points.begin(), points.end());
  if (marks.near) {
    mark_near(std::span(stream_).last(points.size()), near_, *marks.near, *options_.model,
              options_.sample_rate_hz);
  }
  spacing_.add(points);
  if (marks.speckle) marks.speckle->near_ratio = marks.speckle->near_ratio_at(spacing_.step_deg());
  marks.mark_by_neighbours(stream_, scan_ends::open);
  const std::size_t from = passed_on_ - old;
  const std::size_t waiting = is_end ? 0 : window;
  passed_on_ = std::max(from, stream_.size() - std::min(stream_.size(), waiting));
  return std::span(stream_).subspan(from, passed_on_ - from);
}

void shaping_writer::write_points(std::span<const point> points, text_sink& out) {
  if (done_) return;
  points = in_range(points);
  write_stream(marked_stream(points, done_), out);
}

void shaping_writer::finish(text_sink& out) {
  if (done_ || takes_scans() || options_.shape.marks.window() == 0) return;
  write_stream(marked_stream({}, true), out);
  done_ = true;
}

void shaping_writer::write_stream(std::span<const point> points, text_sink& out) {
  if (points.empty()) return;
  has_taken_ = true;
  begin(out);
  follow_wall_clock();
  times_.arrived(points.front().time_ns);
  if (!shaper_.filter().keeps_everything()) {
    shaped_.resize(points.size());
    points = filter_points(points, shaper_.filter(), shaped_);
  }
  pass_on(points, out);
}

void shaping_writer::pass_on(std::span<const point> points, text_sink& out) {
  const std::uint64_t left = options_.count - records_;
  points = points.first(static_cast<std::size_t>(std::min<std::uint64_t>(points.size(), left)));
  inner_->write_points(timed(points), out);
  records_ += points.size();
  done_ = done_ || records_ >= options_.count;
}

std::span<const point> shaping_writer::timed(std::span<const point> points) {
  if (times_.changes_nothing()) return points;
  if (points.data() != shaped_.data()) shaped_.assign(points.begin(), points.end());
  const std::span<point> changed = std::span(shaped_).first(points.size());
  for (point& p : changed) p.time_ns = times_.of(p.time_ns);
  return changed;
}

void shaping_writer::write_scan(const scan_record& record, text_sink& out) {
  if (done_) return;
  begin(out);
  const bool is_in_range = in_range(record.scan.points).size() == record.scan.points.size();
  if (record.scan.is_piece() && !options_.partial_scans) {
    ++pieces_;
    return;
  }
  follow_wall_clock();
  if (!is_in_range) return;
  const std::optional<pose_2d> robot = pose_at(options_.path, record.time_ns);
  if (options_.on_path_only && !robot) {
    ++off_path_;
    return;
  }
  has_taken_ = true;
  times_.arrived(record.time_ns);
  scan_times_.arrived(record.time_ns);
  shaper_.shape(record.scan, options_.path);
  const scan shaped = options_.for_grid ? shaper_.for_grid() : shaper_.kept();
  if (shaper_.outside() > 0) {
    not_deskewed_ +=
        static_cast<std::uint64_t>(std::ranges::count_if(shaped, &point::is_not_deskewed));
  }
  if (!inner_->takes_scans()) return pass_on(shaped.points, out);
  scan_record changed = record;
  changed.scan.points = timed(shaped.points);
  changed.time_ns = scan_times_.of(record.time_ns);
  changed.robot = robot.value_or(record.robot);
  inner_->write_scan(changed, out);
  done_ = ++records_ >= options_.count;
}

}  // namespace g4_tool
