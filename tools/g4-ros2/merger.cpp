// SPDX-License-Identifier: MIT
#include "merger.hpp"

#include <algorithm>
#include <utility>

namespace g4_tool {
namespace {

constexpr std::size_t most_lidars = 32;

}  // namespace

merger::merger(dds::bus& on, const ros2_options& options, const std::vector<named_source>& lidars)
    : messages_(on, options, options.name_space, options.frames.robot) {
  if (lidars.size() > most_lidars) throw bad_value("--merge joins at most 32 lidars");
  if (options.order == scan_order::time) {
    throw bad_value("--merge cannot be used with --order time: a merged scan has no order of time");
  }
  const bool is_by_path = options.common.deskew == deskewing::by_path;
  if (is_by_path) {
    deskewing_ = std::make_unique<deskew_report>(where_odometry_is(options, options.name_space));
  }
  if (is_by_path && options.topics.odometry != "off") {
    driven_ = std::make_unique<odometry_subscription>(
        on, full_name(options.name_space, options.topics.odometry));
  }
  for (const named_source& each : lidars) {
    part& made = parts_.emplace_back();
    made.name = each.name;
    made.place = each.mount.value_or(mounting{});
    if (options.common.deskew == deskewing::by_scans) made.estimator.emplace();
  }
}

void merger::add(std::size_t index, const shaped_scan& scan, const scan_times& when) {
  const std::lock_guard lock(mutex_);
  part& here = parts_[index];
  here.for_grid.assign(scan.for_grid.begin(), scan.for_grid.end());
  here.kept.assign(scan.kept.begin(), scan.kept.end());
  here.end_ns = when.first_ns + when.duration_ns;
  const bool is_leader = std::ranges::none_of(
      std::span(parts_).first(index),
      [&here](const part& earlier) { return here.end_ns - earlier.end_ns < fresh_scan_ns; });
  if (!is_leader) return;
  follow(here, when);
  const std::int64_t reference_ns = here.end_ns;
  const std::int64_t last_ns = std::ranges::max_element(parts_, {}, &part::end_ns)->end_ns;
  const std::span<const stamped_pose> path = path_.until(last_ns);
  const merged grid = merged_points(&part::for_grid, reference_ns, path, for_grid_);
  const merged kept = merged_points(&part::kept, reference_ns, path, kept_);
  ++scans_;
  for (std::size_t i = 0; i < parts_.size(); ++i) parts_[i].lost += std::uint64_t{grid.is_lost(i)};
  if (deskewing_) deskewing_->add(kept.points.size(), kept.outside);
  messages_.publish({grid.points, kept.points, {}, scan.grid},
                    {reference_ns, when.duration_ns, when.ahead_ns});
}

void merger::add(const stamped_odometry& at) {
  const std::lock_guard lock(mutex_);
  has_odometry_ = true;
  path_.add(at);
}

void merger::follow(part& leader, const scan_times& when) {
  if (driven_ && !has_odometry_) driven_->take(path_, when.ahead_ns);
  if (!leader.estimator) return;
  const twist_estimate motion = leader.estimator->add(leader.for_grid);
  if (motion.is_known() || motion.status == twist_status::degenerate) {
    twist_2d twist = motion.twist;
    if (leader.place.upside_down) {  // its y axis points to the other side
      twist = {twist.x_m_per_s, -twist.y_m_per_s, -twist.yaw_rad_per_s};
    }
    twist_ = seen_from(inverse(leader.place.pose), twist);
  } else {
    twist_.reset();
  }
}

merged merger::merged_points(std::vector<point> part::* which, std::int64_t reference_ns,
                             std::span<const stamped_pose> path, std::vector<point>& out) const {
  std::vector<mounted_scan> lidars;
  std::size_t count = 0;
  for (const part& each : parts_) {
    lidars.push_back({each.*which, each.place});
    count += (each.*which).size();
  }
  out.resize(count);
  const merged all = deskewing_
                         ? merge_scans(lidars, path, reference_ns, out)
                         : merge_scans(lidars, twist_.value_or(twist_2d{}), reference_ns, out);
  // All of them are where they would have been seen at that time.
  for (point& p : all.points) p.time_ns = reference_ns;
  return all;
}

std::vector<std::function<diagnostic_status()>> merger::reports() {
  std::vector<std::function<diagnostic_status()>> all{[this] { return status(); }};
  if (deskewing_) all.emplace_back([this] { return deskewing_->status(); });
  return all;
}

diagnostic_status merger::status() {
  const std::lock_guard lock(mutex_);
  diagnostic_status made{.name = "g4lidar: merging", .values = {{"scans", std::to_string(scans_)}}};
  for (part& each : parts_) {
    made.values.emplace_back("scans_without_" + each.name, std::to_string(each.lost));
    if (each.lost == std::exchange(each.lost_before, each.lost)) continue;
    made.level = diagnostic_level::warn;
    made.message += (made.message.empty() ? "without " : ", ") + each.name;
  }
  if (made.message.empty()) made.message = "ok";
  return made;
}

}  // namespace g4_tool
