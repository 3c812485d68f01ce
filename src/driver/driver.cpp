// SPDX-License-Identifier: MIT
#include "driver.hpp"

#include <algorithm>
#include <utility>

#include "driver/file/replay_player.hpp"
#include "driver/live/listening_driver.hpp"
#include "driver/live/live_driver.hpp"

namespace g4lidar {
namespace {

std::unique_ptr<scan_source> make_source(scan_source::parts& parts, const lidar_options& options) {
  if (parts.link.port_connector().traits().answers) {
    if (options.listen_only || options.model->link == link_kind::one_way) {
      return std::make_unique<listening_driver>(parts, options);
    }
    return std::make_unique<live_driver>(parts, options);
  }
  return std::make_unique<replay_player>(parts, options);
}

}  // namespace

lidar::driver::driver(std::unique_ptr<connector> connector, const lidar_options& options,
                      const g4lidar::recognition& known)
    : parts_{connection(std::move(connector), options.device),
             point_pipeline(options.tuning.transport_delay.count(), options.partial_scans,
                            *options.model),
             {},
             {known, *options.model}},
      source_(make_source(parts_, options)),
      points_(largest_scan(*options.model)) {
  if (options.zero_angle)
    parts_.pipeline.zero().set(*options.zero_angle, zero_offset::stated_by::user);
}

lidar::driver::~driver() { static_cast<void>(close()); }

result<void> lidar::driver::open() {
  if (parts_.link.port_connector().traits().recognised.was_stopped) {
    parts_.events.put({lidar_event::kind::found_scanning, problem::timeout, parts_.link.now_ns()});
  }
  auto opened = source_->open();
  if (opened) parts_.recognised.record(parts_.link.port_connector());
  return opened;
}

result<void> lidar::driver::close() {
  result<void> stopped;
  while (source_->has_motor_on()) {
    stopped = stop();
    if (stopped || stopped.error() != problem::cancelled) break;
  }
  source_->release(true);
  drop_points();
  return stopped;
}

void lidar::driver::release() noexcept {
  source_->release(false);
  drop_points();
}

void lidar::driver::drop_points() noexcept {
  const std::uint64_t dropped = parts_.pipeline.drop_points();
  if (hands_points_over_) points_missed_ += dropped;
}

/// Available points are returned before any error.
result<std::span<const point>> lidar::driver::next_points(milliseconds timeout) {
  hands_points_over_ = true;
  source_->take_points();
  const std::int64_t deadline_ns = deadline_after_ns(*source_, timeout);
  bool last = false;
  while (true) {
    const ring_read read = parts_.pipeline.read(points_.all());
    points_missed_ += read.missed;
    if (read.points > 0) return points_.all().first(read.points);
    if (auto able = source_->can_read(); !able) return tl::unexpected(able.error());
    if (last) return timed_out(false);
    parts_.pipeline.drop_scan();
    if (auto done = source_->step(source_->step_until_ns(deadline_ns)); !done)
      return tl::unexpected(done.error());
    last = is_over(deadline_ns);
  }
}

result<void> lidar::driver::process() {
  parts_.pipeline.drop_scan();
  return source_->step(parts_.link.now_ns());
}

lidar_counts lidar::driver::counts() const noexcept {
  lidar_counts all = parts_.pipeline.counts();
  if (hands_points_over_) all.points_missed = points_missed_ + parts_.pipeline.unwritten();
  source_->add_to(all);
  return all;
}

}  // namespace g4lidar
