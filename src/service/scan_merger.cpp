// SPDX-License-Identifier: MIT
#include "service/scan_merger.hpp"

#include <algorithm>
#include <utility>

#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/grid.hpp"

namespace g4lidar {

scan_merger::scan_merger(deskewing deskewing, const std::vector<merged_lidar>& lidars)
    : deskew_(deskewing) {
  for (const merged_lidar& each : lidars) {
    part& made = parts_.emplace_back();
    made.name = each.name;
    made.place = each.place;
  }
}

std::optional<merged_scan> scan_merger::add(std::size_t index, scan_shaper& shaper,
                                            std::int64_t first_ns, std::int64_t duration_ns,
                                            bool wants_kept, const path_until& path) {
  part& here = parts_[index];
  const auto copy = [](std::vector<point>& kept, std::span<const point> points) {
    kept.assign(points.begin(), points.end());
  };
  const scan for_grid = shaper.for_grid();
  copy(here.for_grid, for_grid.points);
  here.model = for_grid.model;
  copy(here.kept, wants_kept ? shaper.kept().points : std::span<const point>());
  here.end_ns = detail::saturating_add(first_ns, duration_ns);
  for (std::size_t earlier = 0; earlier < index; ++earlier) {
    if (detail::saturating_sub(here.end_ns, parts_[earlier].end_ns) < fresh_scan_ns)
      return std::nullopt;  // that one leads
  }
  const g4lidar::model& measured = merged_model();
  merged_scan made{.for_grid = {.points = {}, .model = &measured},
                   .kept = {.points = {}, .model = &measured},
                   .kept_of_each = {},
                   .reference_ns = here.end_ns,
                   .moved = motion_of_robot(here, shaper, path)};
  const merged all = merged_points(&part::for_grid, here.end_ns, made.moved, for_grid_);
  ++scans_;
  for (std::size_t i = 0; i < parts_.size(); ++i) parts_[i].lost += std::uint64_t{all.is_lost(i)};
  made.outside = all.outside;
  made.for_grid.points = all.points;
  if (!wants_kept) return made;
  const merged kept = merged_points(&part::kept, here.end_ns, made.moved, kept_);
  made.kept.points = kept.points;
  kept_of_each_.clear();
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    kept_of_each_.push_back(kept.is_lost(i) ? 0 : parts_[i].kept.size());
  }
  made.kept_of_each = kept_of_each_;
  return made;
}

const model& scan_merger::merged_model() {
  const auto bits_of = [](const part& each) { return intensity_bits(each.model->samples.layout); };
  g4lidar::model made = *std::ranges::max_element(parts_, {}, bits_of)->model;
  made.turn_deg = g4_model.turn_deg;
  made.rates = std::ranges::max_element(parts_, {}, [](const part& each) {
                 return default_bins(*each.model);
               })->model->rates;
  for (const part& each : parts_) {
    made.range.min_mm = std::min(made.range.min_mm, each.model->range.min_mm);
    made.range.max_mm = std::max(made.range.max_mm, each.model->range.max_mm);
  }
  // Another one only when a lidar turns out to be of another model.
  const auto is_same = [&made](const g4lidar::model& last) {
    return last.word == made.word && last.samples.layout == made.samples.layout &&
           default_bins(last) == default_bins(made) && last.range.min_mm == made.range.min_mm &&
           last.range.max_mm == made.range.max_mm;
  };
  if (models_.empty() || !is_same(models_.back())) models_.push_back(made);
  return models_.back();
}

robot_motion scan_merger::motion_of_robot(const part& leader, const scan_shaper& shaper,
                                          const path_until& path) const {
  if (deskew_ == deskewing::none) return {.twist = twist_2d{}, .path = {}};
  if (deskew_ == deskewing::by_path) {
    return {.twist = {}, .path = path(std::ranges::max_element(parts_, {}, &part::end_ns)->end_ns)};
  }
  if (!shaper.twist()) return {};
  const twist_2d twist = leader.place.upright(*shaper.twist());
  return {.twist = seen_from(inverse(leader.place.pose), twist), .path = {}};
}

merged scan_merger::merged_points(std::vector<point> part::* member, std::int64_t reference_ns,
                                  const robot_motion& moved, std::vector<point>& out) const {
  std::vector<mounted_scan> lidars;
  std::size_t count = 0;
  for (const part& each : parts_) {
    lidars.push_back({each.*member, each.place, each.model->turn_deg});
    count += (each.*member).size();
  }
  out.resize(count);
  const merged all = moved.twist ? merge_scans(lidars, *moved.twist, reference_ns, out)
                                 : merge_scans(lidars, moved.path, reference_ns, out);
  if (deskew_ == deskewing::none) return all;
  // These are where they would have been seen at that time.
  for (point& p : all.points) {
    if (!p.is_not_deskewed()) p.time_ns = reference_ns;
  }
  return all;
}

diagnostic_status scan_merger::status() {
  diagnostic_status made{.name = "g4lidar: merging", .values = {{"scans", std::to_string(scans_)}}};
  for (part& each : parts_) {
    const std::uint64_t lost = each.lost;
    made.values.emplace_back("scans_without_" + each.name, std::to_string(lost));
    if (lost == std::exchange(each.lost_before, lost)) continue;
    made.level = diagnostic_level::warn;
    made.message += (made.message.empty() ? "without " : ", ") + each.name;
  }
  if (made.message.empty()) made.message = "ok";
  return made;
}

}  // namespace g4lidar
