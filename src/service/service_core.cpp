// SPDX-License-Identifier: MIT
#include "service/service_core.hpp"

#include <utility>

#include "g4lidar/transport/source.hpp"

namespace g4lidar {
namespace {

/// Merged lidars are on one robot: that of the first one, whose source may state its motion.
deskewing merged_deskewing(const service_options& options, const service_lidar& first) {
  const bool follows = options.deskew == deskewing::none && options.follows_motion;
  return follows && has_simulated_robot(first.options.device) ? deskewing::by_path : options.deskew;
}

}  // namespace

service_core::service_core(service_options options, const std::vector<service_lidar>& lidars,
                           const std::vector<service_output>& outputs)
    : options_(std::move(options)), sinks_(outputs), filters_(options_.filters) {
  deskewing deskew = options_.deskew;
  if (lidars.size() > 1 || options_.merges) {
    deskew = merged_deskewing(options_, lidars.front());
    std::vector<scan_merger::merged_lidar> parts;
    parts.reserve(lidars.size());
    for (const service_lidar& each : lidars)
      parts.push_back({each.name, each.mount.value_or(mounting{})});
    merger_.emplace(deskew, parts);
  }
  for (const service_lidar& each : lidars) {
    shaping& made = lidars_.emplace_back();
    made.mount = each.mount;
    made.place = each.mount.value_or(mounting{});
    made.deskew = deskew;
  }
}

void service_core::begin(bool has_odometry) {
  const deskewing deskew = lidars_.front().deskew;
  if (deskew == deskewing::none) return;
  const bool is_elsewhere = options_.other_odometry && !has_odometry;
  watch_.emplace(deskew, is_elsewhere ? options_.other_odometry_place : "in the source");
}

std::string service_core::problem_with(std::span<const named_value> wanted) const {
  if (wanted.empty()) return {};
  lidar_parameters trial(filters_.current_filters());
  return trial.change(nullptr, wanted);
}

std::string service_core::set_filters(std::span<const named_value> wanted) {
  if (wanted.empty()) return {};
  const std::lock_guard lock(changes_);
  std::string wrong = filters_.change(nullptr, wanted);
  ++version_;
  return wrong;
}

void service_core::opened(std::size_t lidar, const known_motion& motion) {
  const std::lock_guard lock(sinks_.mutex());
  shaping& here = lidars_[lidar];
  here.has_odometry = motion.has_odometry;
  if (!merger_) {
    const std::optional<mounting> known = here.mount ? here.mount : motion.simulated;
    here.place = known.value_or(mounting{});
    const bool follows = options_.deskew == deskewing::none && options_.follows_motion && known;
    here.deskew = follows && motion.has_odometry ? deskewing::by_path : options_.deskew;
  }
  here.version = 0;
}

void service_core::update(shaping& of) {
  const unsigned now = version_;
  if (std::exchange(of.version, now) == now) return;
  of.filters = filters_.current_filters();
  shaping_options made{.filter = of.filters.complete_filter(),
                       .marks = of.filters.marks,
                       .deskew = of.deskew,
                       .mount = of.place,
                       .restamps = options_.restamps,
                       .for_merging = merger_.has_value()};
  made.filter.masks = options_.mask.polygons();
  of.shaper.set_options(made);
}

void service_core::add(const stamped_odometry& now, std::int64_t stamp_ns, std::uint64_t begun) {
  const std::lock_guard lock(sinks_.mutex());
  path_.add(now);
  begun_ = begun;
  sinks_.each([&](service_sink& to) { to.on_odometry(now, stamp_ns); });
}

void service_core::add(std::size_t lidar, const scan& found, std::optional<std::int64_t> ahead_ns) {
  update(lidars_[lidar]);
  if (merger_)
    add_merged(lidar, found, ahead_ns);
  else
    add_single(lidars_[lidar], found, ahead_ns);
}

void service_core::take_other_odometry(const shaping& lidar, const scan& found,
                                       std::optional<std::int64_t> ahead_ns) {
  const bool is_wanted = lidar.deskew == deskewing::by_path && !lidar.has_odometry && ahead_ns;
  if (is_wanted && options_.other_odometry) options_.other_odometry(path_, found, *ahead_ns);
}

void service_core::add_single(shaping& lidar, const scan& found,
                              std::optional<std::int64_t> ahead_ns) {
  take_other_odometry(lidar, found, ahead_ns);
  const auto path = path_.until(found.end_ns());
  lidar.shaper.shape(found, path);
  service_scan made{.made = sinks_.wanted(),
                    .grid = lidar.filters.grid,
                    .first_ns = found.time_ns(),
                    .duration_ns = found.duration_ns,
                    .ahead_ns = ahead_ns,
                    .is_upside_down = lidar.place.upside_down};
  if (!found.empty() && found.time_ns() != 0) {
    if (lidar.deskew == deskewing::by_path)
      made.place = tracker_.by_path(path, lidar.place.pose, found.time_ns(), begun_);
    if (lidar.deskew == deskewing::by_scans) {
      std::optional<twist_2d> twist = lidar.shaper.twist();
      if (twist) twist = lidar.place.upright(*twist);
      made.place = tracker_.by_twist(twist, found.time_ns());
    }
  }
  made.for_grid = made.kept = found;
  made.for_grid.points = made.kept.points = {};
  if (made.made.for_grid) made.for_grid = lidar.shaper.for_grid();
  if (made.made.kept) made.kept = lidar.shaper.kept();
  const std::lock_guard lock(sinks_.mutex());
  give(made, found.size(), lidar.shaper.outside());
}

void service_core::add_merged(std::size_t lidar, const scan& found,
                              std::optional<std::int64_t> ahead_ns) {
  if (found.is_piece()) return;
  shaping& here = lidars_[lidar];
  here.shaper.shape(found);
  service_scan made{.made = sinks_.wanted(),
                    .grid = here.filters.grid,
                    .duration_ns = found.duration_ns,
                    .ahead_ns = ahead_ns};
  const std::lock_guard lock(sinks_.mutex());
  const auto path = [&](std::int64_t end_ns) {
    take_other_odometry(lidars_.front(), found, ahead_ns);
    return path_.until(end_ns);
  };
  scan_merger& merger = *merger_;  // NOLINT(bugprone-unchecked-optional-access): see add()
  const auto joined =
      merger.add(lidar, here.shaper, found.time_ns(), found.duration_ns, made.made.kept, path);
  if (!joined) return;
  made.made.for_grid = true;
  made.for_grid = joined->for_grid;
  made.kept = joined->kept;
  for (scan* const each : {&made.for_grid, &made.kept}) {
    each->revolution = found.revolution;
    each->turned_deg = found.turned_deg;
    each->duration_ns = found.duration_ns;
  }
  made.kept_of_each = joined->kept_of_each;
  made.first_ns = joined->reference_ns;
  if (here.deskew == deskewing::by_path)
    made.place = tracker_.by_path(joined->moved.path, {}, made.first_ns, begun_);
  if (here.deskew == deskewing::by_scans)
    made.place = tracker_.by_twist(joined->moved.twist, made.first_ns);
  give(made, made.for_grid.size(), joined->outside);
}

void service_core::give(service_scan& made, std::size_t points, std::size_t outside) {
  const std::optional<bool> changed = watch_ ? watch_->add(points, outside) : std::nullopt;
  sinks_.each([&](service_sink& to) {
    if (changed) to.on_motion(*changed, *changed ? "" : watch_->hint());
    to.on_scan(made);
  });
}

std::vector<diagnostic_status> service_core::diagnosis() {
  std::vector<diagnostic_status> all;
  if (merger_) all.push_back(merger_->status());
  if (watch_) all.push_back(watch_->status());
  return all;
}

}  // namespace g4lidar
