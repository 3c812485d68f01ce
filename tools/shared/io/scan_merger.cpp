// SPDX-License-Identifier: MIT
#include "scan_merger.hpp"

#include <algorithm>
#include <utility>

#include "cli/rows.hpp"
#include "g4lidar/grid.hpp"
#include "io/far_times.hpp"

namespace g4_tool {
namespace {

using g4lidar::point;

constexpr std::size_t most_lidars = 32;

}  // namespace

scan_merger::scan_merger(deskewing how, const std::vector<named_source>& lidars,
                         const std::string& where, odometry_source others)
    : deskew_(how), others_(std::move(others)) {
  if (lidars.size() > most_lidars) throw bad_value("--merge joins at most 32 lidars");
  if (deskew_ != deskewing::none) report_ = std::make_unique<deskew_report>(deskew_, where);
  for (const named_source& each : lidars) {
    part& made = parts_.emplace_back();
    made.name = each.name;
    made.place = each.mount.value_or(g4lidar::mounting{});
  }
}

void scan_merger::add(std::size_t index, g4lidar::scan_shaper& scan, const scan_times& when,
                      bool wants_points, const taker& take) {
  const std::lock_guard lock(mutex_);
  part& here = parts_[index];
  const auto copy = [](std::vector<point>& to, std::span<const point> from) {
    to.assign(from.begin(), from.end());
  };
  const g4lidar::scan for_grid = scan.for_grid();
  copy(here.for_grid, for_grid.points);
  here.model = for_grid.model;
  if (wants_points) copy(here.kept, scan.kept().points);
  here.end_ns = sum_ns(when.first_ns, when.duration_ns);
  const bool is_leader =
      std::ranges::none_of(std::span(parts_).first(index), [&here](const part& earlier) {
        return way_ns(earlier.end_ns, here.end_ns) < g4lidar::fresh_scan_ns;
      });
  if (!is_leader) return;
  const g4lidar::model which = merged_model();
  merged_scan made{.for_grid = {.points = {}, .model = &which},
                   .kept = {.points = {}, .model = &which},
                   .kept_of_each = {},
                   .when = {here.end_ns, when.duration_ns, when.ahead_ns},
                   .moved = motion_of_robot(here, scan, when)};
  const g4lidar::merged all = merged_points(&part::for_grid, here.end_ns, made.moved, for_grid_);
  ++scans_;
  for (std::size_t i = 0; i < parts_.size(); ++i) parts_[i].lost += std::uint64_t{all.is_lost(i)};
  if (report_) report_->add(all.points.size(), all.outside);
  made.for_grid.points = all.points;
  if (wants_points) {
    const g4lidar::merged kept = merged_points(&part::kept, here.end_ns, made.moved, kept_);
    made.kept.points = kept.points;
    kept_of_each_.clear();
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      kept_of_each_.push_back(kept.is_lost(i) ? 0 : parts_[i].kept.size());
    }
    made.kept_of_each = kept_of_each_;
  }
  take(made);
}

g4lidar::model scan_merger::merged_model() const {
  const auto bits_of = [](const part& each) {
    return g4lidar::intensity_bits(each.model->samples.layout);
  };
  g4lidar::model made = *std::ranges::max_element(parts_, {}, bits_of)->model;
  made.turn_deg = g4lidar::g4_model.turn_deg;
  made.rates = std::ranges::max_element(parts_, {}, [](const part& each) {
                 return g4lidar::default_bins(*each.model);
               })->model->rates;
  for (const part& each : parts_) {
    made.range.min_mm = std::min(made.range.min_mm, each.model->range.min_mm);
    made.range.max_mm = std::max(made.range.max_mm, each.model->range.max_mm);
  }
  return made;
}

void scan_merger::add(const g4lidar::stamped_odometry& at) {
  const std::lock_guard lock(mutex_);
  has_odometry_ = true;
  path_.add(at);
}

robot_motion scan_merger::motion_of_robot(const part& leader, const g4lidar::scan_shaper& scan,
                                          const scan_times& when) {
  using g4lidar::twist_2d;
  if (deskew_ == deskewing::none) return {.twist = twist_2d{}, .path = {}};
  if (deskew_ == deskewing::by_path) {
    if (others_ && !has_odometry_) others_(path_, when.ahead_ns);
    return {.twist = {},
            .path = path_.until(std::ranges::max_element(parts_, {}, &part::end_ns)->end_ns)};
  }
  if (!scan.twist()) return {};
  const twist_2d twist = leader.place.upright(*scan.twist());
  return {.twist = seen_from(inverse(leader.place.pose), twist), .path = {}};
}

g4lidar::merged scan_merger::merged_points(std::vector<point> part::* which,
                                           std::int64_t reference_ns, const robot_motion& moved,
                                           std::vector<point>& out) const {
  std::vector<g4lidar::mounted_scan> lidars;
  std::size_t count = 0;
  for (const part& each : parts_) {
    lidars.push_back({each.*which, each.place, each.model->turn_deg});
    count += (each.*which).size();
  }
  out.resize(count);
  const g4lidar::merged all = moved.twist
                                  ? g4lidar::merge_scans(lidars, *moved.twist, reference_ns, out)
                                  : g4lidar::merge_scans(lidars, moved.path, reference_ns, out);
  if (deskew_ == deskewing::none) return all;
  // These are where they would have been seen at that time.
  for (point& p : all.points) {
    if (!p.is_not_deskewed()) p.time_ns = reference_ns;
  }
  return all;
}

std::vector<std::function<g4lidar::diagnostic_status()>> scan_merger::reports() {
  std::vector<std::function<g4lidar::diagnostic_status()>> all{[this] { return status(); }};
  if (report_) all.emplace_back([this] { return report_->status(); });
  return all;
}

g4lidar::diagnostic_status scan_merger::status() {
  const std::lock_guard lock(mutex_);
  g4lidar::diagnostic_status made{.name = "g4lidar: merging",
                                  .values = {{"scans", std::to_string(scans_)}}};
  for (part& each : parts_) {
    made.values.emplace_back("scans_without_" + each.name, std::to_string(each.lost));
    if (each.lost == std::exchange(each.lost_before, each.lost)) continue;
    made.level = g4lidar::diagnostic_level::warn;
    made.message += (made.message.empty() ? "without " : ", ") + each.name;
  }
  if (made.message.empty()) made.message = "ok";
  return made;
}

}  // namespace g4_tool
