// SPDX-License-Identifier: MIT
#include "shaped_writer.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace g4_dump {
namespace {

template <class Clock>
std::int64_t now_ns() noexcept {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch())
      .count();
}

}  // namespace

std::int64_t wall_ahead_ns() noexcept {
  return now_ns<std::chrono::system_clock>() - now_ns<std::chrono::steady_clock>();
}

shaped_writer::shaped_writer(std::unique_ptr<point_writer> inner, const common_options& options,
                             const shape_plan& plan)
    : inner_(std::move(inner)),
      plan_(plan),
      count_(options.count == 0 ? UINT64_MAX : options.count),
      duration_ns_(plan.counts_duration ? options.duration.count() : 0),
      shaper_(options, plan.purpose),
      times_(plan.time, plan.wall_ahead_ns),
      scan_times_(plan.time, plan.wall_ahead_ns) {}

void shaped_writer::begin(output& out) {
  if (begun_) return;
  begun_ = true;
  inner_->begin(out);
}

void shaped_writer::look_at_clock() {
  if (!plan_.follows_wall_clock) return;
  const std::int64_t ahead_ns = wall_ahead_ns();
  times_.set_wall_ahead(ahead_ns);
  scan_times_.set_wall_ahead(ahead_ns);
}

std::span<const g4lidar::point> shaped_writer::in_time(std::span<const g4lidar::point> points) {
  if (duration_ns_ == 0 || points.empty()) return points;
  if (!first_ns_) first_ns_ = points.front().time_ns;
  const std::int64_t end_ns = *first_ns_ + duration_ns_;
  if (points.back().time_ns < end_ns) return points;
  const auto late = std::find_if(points.begin(), points.end(),
                                 [end_ns](const g4lidar::point& p) { return p.time_ns >= end_ns; });
  done_ = late != points.end();
  return points.first(static_cast<std::size_t>(late - points.begin()));
}

void shaped_writer::write_points(std::span<const g4lidar::point> points, output& out) {
  if (points.empty() || done_) return;
  begin(out);
  look_at_clock();
  times_.come(points.front().time_ns);
  points = in_time(points);
  while (!points.empty() && records_ < count_) {
    const auto piece = points.first(std::min(points.size(), max_points));
    points = points.subspan(piece.size());
    auto shaped = shaper_.shape(piece);
    shaped = shaped.first(
        static_cast<std::size_t>(std::min<std::uint64_t>(shaped.size(), count_ - records_)));
    for (g4lidar::point& p : shaped) p.time_ns = times_.of(p.time_ns);
    inner_->write_points(shaped, out);
    records_ += shaped.size();
  }
  if (records_ >= count_) done_ = true;
}

void shaped_writer::write_scan(const shown_scan& shown, output& out) {
  if (done_) return;
  begin(out);
  if (shown.scan.is_partial() && !plan_.partial_scans) {
    ++pieces_;
    return;
  }
  look_at_clock();
  if (in_time(shown.scan.points).size() < shown.scan.points.size()) return;
  times_.come(shown.time_ns);
  scan_times_.come(shown.time_ns);
  shown_scan changed = shown;
  const auto shaped = shaper_.shape(shown.scan.points);
  for (g4lidar::point& p : shaped) p.time_ns = times_.of(p.time_ns);
  changed.scan.points = shaped;
  changed.time_ns = scan_times_.of(shown.time_ns);
  inner_->write_scan(changed, out);
  ++records_;
  if (records_ >= count_) done_ = true;
}

}  // namespace g4_dump
