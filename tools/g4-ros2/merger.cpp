// SPDX-License-Identifier: MIT
#include "merger.hpp"

#include <algorithm>
#include <utility>

namespace g4_tool {
namespace {

constexpr std::size_t most_lidars = 32;

}  // namespace

merger::merger(dds::bus& on, const ros2_options& options, const std::vector<named_source>& lidars)
    : messages_(on, options, options.name_space, options.frames.robot),
      deskew_(options.common.deskew) {
  if (lidars.size() > most_lidars) throw bad_value("--merge joins at most 32 lidars");
  if (options.order == scan_order::time) {
    throw bad_value("--merge cannot be used with --order time: a merged scan has no order of time");
  }
  if (deskew_ != deskewing::none) {
    report_ =
        std::make_unique<deskew_report>(deskew_, where_odometry_is(options, options.name_space));
  }
  if (deskew_ == deskewing::by_path && options.topics.odometry != "off") {
    driven_ = std::make_unique<odometry_subscription>(
        on, full_name(options.name_space, options.topics.odometry));
  }
  for (const named_source& each : lidars) {
    part& made = parts_.emplace_back();
    made.name = each.name;
    made.place = each.mount.value_or(mounting{});
  }
}

void merger::add(std::size_t index, scan_shaper& scan, const grid_options& grid,
                 const scan_times& when) {
  const std::lock_guard lock(mutex_);
  const bool wants_points = messages_.wants_points();
  part& here = parts_[index];
  const auto take = [](std::vector<point>& to, std::span<const point> from) {
    to.assign(from.begin(), from.end());
  };
  const g4lidar::scan for_grid = scan.for_grid();
  take(here.for_grid, for_grid.points);
  here.model = for_grid.model;
  if (wants_points) take(here.kept, scan.kept().points);
  here.end_ns = when.first_ns + when.duration_ns;
  const bool is_leader = std::ranges::none_of(
      std::span(parts_).first(index),
      [&here](const part& earlier) { return here.end_ns - earlier.end_ns < fresh_scan_ns; });
  if (!is_leader) return;
  const motion moved = motion_of_robot(here, scan, when);
  const scan_times merged_at{here.end_ns, when.duration_ns, when.ahead_ns};
  const merged all = merged_points(&part::for_grid, here.end_ns, moved, for_grid_);
  ++scans_;
  for (std::size_t i = 0; i < parts_.size(); ++i) parts_[i].lost += std::uint64_t{all.is_lost(i)};
  if (report_) report_->add(all.points.size(), all.outside);
  const g4lidar::model which = merged_model();
  g4lidar::scan made{.points = all.points, .model = &which};
  if (messages_.wants_scan()) messages_.publish_scan(made, grid, merged_at);
  if (!wants_points) return;
  made.points = merged_points(&part::kept, here.end_ns, moved, kept_).points;
  messages_.publish_points(made, merged_at);
}

g4lidar::model merger::merged_model() const {
  const auto longest_of = [](const part& each) {
    return longest_range_mm(each.model->samples.layout);
  };
  g4lidar::model made = *std::ranges::max_element(parts_, {}, longest_of)->model;
  made.turn_deg = g4_model.turn_deg;
  made.rates = std::ranges::max_element(parts_, {}, [](const part& each) {
                 return default_bins(*each.model);
               })->model->rates;
  for (const part& each : parts_) {
    made.range.min_mm = std::min(made.range.min_mm, each.model->range.min_mm);
  }
  return made;
}

void merger::add(const stamped_odometry& at) {
  const std::lock_guard lock(mutex_);
  has_odometry_ = true;
  path_.add(at);
}

merger::motion merger::motion_of_robot(const part& leader, const scan_shaper& scan,
                                       const scan_times& when) {
  if (deskew_ == deskewing::none) return {.twist = twist_2d{}, .path = {}};
  if (deskew_ == deskewing::by_path) {
    if (driven_ && !has_odometry_) driven_->take(path_, when.ahead_ns);
    return {.twist = {},
            .path = path_.until(std::ranges::max_element(parts_, {}, &part::end_ns)->end_ns)};
  }
  if (!scan.twist()) return {};
  twist_2d twist = *scan.twist();
  if (leader.place.upside_down) {  // its y axis points to the other side
    twist = {twist.x_m_per_s, -twist.y_m_per_s, -twist.yaw_rad_per_s};
  }
  return {.twist = seen_from(inverse(leader.place.pose), twist), .path = {}};
}

merged merger::merged_points(std::vector<point> part::* which, std::int64_t reference_ns,
                             const motion& moved, std::vector<point>& out) const {
  std::vector<mounted_scan> lidars;
  std::size_t count = 0;
  for (const part& each : parts_) {
    lidars.push_back({each.*which, each.place, each.model->turn_deg});
    count += (each.*which).size();
  }
  out.resize(count);
  const merged all = moved.twist ? merge_scans(lidars, *moved.twist, reference_ns, out)
                                 : merge_scans(lidars, moved.path, reference_ns, out);
  // All of them are where they would have been seen at that time.
  for (point& p : all.points) p.time_ns = reference_ns;
  return all;
}

std::vector<std::function<diagnostic_status()>> merger::reports() {
  std::vector<std::function<diagnostic_status()>> all{[this] { return status(); }};
  if (report_) all.emplace_back([this] { return report_->status(); });
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
