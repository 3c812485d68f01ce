// SPDX-License-Identifier: MIT
// Points, grids, filters and outliers: the functions of the core for the memory of the caller.
#include <g4lidar/c/filter.h>
#include <g4lidar/c/point.h>

#include <array>
#include <bit>
#include <limits>
#include <memory>
#include <variant>
#include <vector>

#include "border.hpp"
#include "g4lidar/cartesian.hpp"
#include "g4lidar/export/mask.hpp"
#include "g4lidar/filter.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/outliers.hpp"
#include "ranges.hpp"

using namespace g4lidar;
using namespace g4lidar::c;

struct g4lidar_mask {
  mask made;
  std::vector<g4lidar_polygon> polygons;
};

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr g4lidar_filter_options filter_defaults{sizeof(g4lidar_filter_options),
                                                 nullptr,
                                                 0,
                                                 nullptr,
                                                 0,
                                                 {0.0, 360.0},
                                                 0.0F,
                                                 infinity,
                                                 G4LIDAR_VENDOR,
                                                 0,
                                                 false,
                                                 false,
                                                 {}};
constexpr g4lidar_outlier_options outlier_defaults{
    sizeof(g4lidar_outlier_options), 2, 1, 0.05F, 0.05F, 1, 5.0F, false, {}};

constexpr bool is_frame(int value) noexcept {
  return value == G4LIDAR_VENDOR || value == G4LIDAR_ROBOT;
}
constexpr frame frame_of(int value) noexcept {
  return value == G4LIDAR_ROBOT ? frame::robot : frame::vendor;
}

/// The filter of the options, in memory on the stack; without allocation there are limits.
class taken_filter {
 public:
  /// Whether the options can be used.
  [[nodiscard]] bool take(const g4lidar_filter_options* given) noexcept {
    g4lidar_filter_options options = filter_defaults;
    if (!take_options(given, options) || !is_frame(options.frame)) return false;
    if (options.ignored_sector_count > sectors_.size() ||
        (options.ignored_sectors == nullptr && options.ignored_sector_count > 0) ||
        options.mask_count > masks_.size() ||
        (options.masks == nullptr && options.mask_count > 0) || options.excluded_flags > 0xFF) {
      return false;
    }
    for (std::size_t i = 0; i < options.ignored_sector_count; ++i) {
      sectors_[i] = {options.ignored_sectors[i].from_deg, options.ignored_sectors[i].to_deg};
    }
    for (std::size_t i = 0; i < options.mask_count; ++i) {
      const g4lidar_polygon& each = options.masks[i];
      if (each.corners == nullptr && each.count > 0) return false;
      masks_[i] = {reinterpret_cast<const corner*>(each.corners), each.count};
    }
    filter_.in = frame_of(options.frame);
    filter_.field_of_view = {options.field_of_view.from_deg, options.field_of_view.to_deg};
    filter_.ignored_sectors = std::span(sectors_).first(options.ignored_sector_count);
    filter_.masks = std::span(masks_).first(options.mask_count);
    filter_.least_range_mm = options.least_range_mm;
    filter_.greatest_range_mm = options.greatest_range_mm;
    filter_.returns_only = options.returns_only;
    filter_.trusted_only = options.trusted_only;
    filter_.excluded = static_cast<point_flags>(options.excluded_flags);
    return true;
  }
  [[nodiscard]] const point_filter& filter() const noexcept { return filter_; }

 private:
  std::array<sector, 256> sectors_;
  std::array<polygon, max_mask_polygons> masks_;
  point_filter filter_;
};

template <class Filter>
int filtered(const g4lidar_point* points, std::size_t count, const g4lidar_filter_options* options,
             g4lidar_point* out, std::size_t* kept, Filter filter) noexcept {
  taken_filter taken;
  if (kept == nullptr || (count > 0 && (points == nullptr || out == nullptr)) ||
      !taken.take(options)) {
    return G4LIDAR_BAD_ARGUMENT;
  }
  *kept = filter(points_of(points, count), taken.filter(), points_of(out, count)).size();
  return G4LIDAR_OK;
}

template <class Mark>
int marked_by(g4lidar_point* points, std::size_t count, const g4lidar_outlier_options* given,
              std::size_t* marked, Mark mark) noexcept {
  g4lidar_outlier_options options = outlier_defaults;
  const auto is_window = [](std::uint32_t value) { return value >= 1 && value <= max_window; };
  if ((count > 0 && points == nullptr) || !take_options(given, options) ||
      !is_window(options.window) || !is_window(options.edge_window) ||
      !(options.least_angle_deg > 0.0F && options.least_angle_deg <= 45.0F) ||
      !(options.near_m >= 0.0F) || !(options.near_ratio >= 0.0F)) {
    return G4LIDAR_BAD_ARGUMENT;
  }
  const auto ends = options.is_piece ? scan_ends::open : scan_ends::joined;
  const std::size_t found = mark(points_of(points, count), options, ends);
  if (marked != nullptr) *marked = found;
  return G4LIDAR_OK;
}

}  // namespace

int g4lidar_to_xy(const g4lidar_point* points, size_t count, int frame, g4lidar_xy* out) {
  if (!is_frame(frame) || (count > 0 && (points == nullptr || out == nullptr))) {
    return G4LIDAR_BAD_ARGUMENT;
  }
  to_xy(points_of(points, count), frame_of(frame), {reinterpret_cast<xy_point*>(out), count});
  return G4LIDAR_OK;
}

int g4lidar_to_polar(const g4lidar_point* points, size_t count, int frame, g4lidar_polar* out) {
  if (!is_frame(frame) || (count > 0 && (points == nullptr || out == nullptr))) {
    return G4LIDAR_BAD_ARGUMENT;
  }
  to_polar(points_of(points, count), frame_of(frame), {reinterpret_cast<polar*>(out), count});
  return G4LIDAR_OK;
}

void g4lidar_grid_options_init(g4lidar_grid_options* options, size_t size) {
  set_defaults(options, size, grid_defaults);
}

int g4lidar_fill_grid(const g4lidar_point* points, size_t count,
                      const g4lidar_grid_options* options, float* ranges_m, size_t bins) {
  g4lidar_grid_options taken = grid_defaults;
  constexpr std::size_t most = std::size_t{1} << 24;
  if (ranges_m == nullptr || bins == 0 || (count > 0 && points == nullptr) || count > most ||
      !take_options(options, taken)) {
    return G4LIDAR_BAD_ARGUMENT;
  }
  const auto how = grid_of(taken);
  if (!how) return G4LIDAR_BAD_ARGUMENT;
  fill_grid(points_of(points, count), {ranges_m, bins}, *how);
  return G4LIDAR_OK;
}

void g4lidar_filter_options_init(g4lidar_filter_options* options, size_t size) {
  set_defaults(options, size, filter_defaults);
}

int g4lidar_filter_points(const g4lidar_point* points, size_t count,
                          const g4lidar_filter_options* options, g4lidar_point* out, size_t* kept) {
  return filtered(points, count, options, out, kept,
                  [](std::span<const point> in, const point_filter& by, std::span<point> to) {
                    return filter_points(in, by, to);
                  });
}

int g4lidar_filter_for_grid(const g4lidar_point* points, size_t count,
                            const g4lidar_filter_options* options, g4lidar_point* out,
                            size_t* kept) {
  return filtered(points, count, options, out, kept,
                  [](std::span<const point> in, const point_filter& by, std::span<point> to) {
                    return filter_for_grid(in, by, to);
                  });
}

void g4lidar_outlier_options_init(g4lidar_outlier_options* options, size_t size) {
  set_defaults(options, size, outlier_defaults);
}

int g4lidar_mark_isolated(g4lidar_point* points, size_t count,
                          const g4lidar_outlier_options* options, size_t* marked) {
  return marked_by(points, count, options, marked,
                   [](std::span<point> all, const g4lidar_outlier_options& by, scan_ends ends) {
                     return mark_isolated(all, {by.window, by.near_count, by.near_m, by.near_ratio},
                                          ends);
                   });
}

int g4lidar_mark_veiling(g4lidar_point* points, size_t count,
                         const g4lidar_outlier_options* options, size_t* marked) {
  return marked_by(points, count, options, marked,
                   [](std::span<point> all, const g4lidar_outlier_options& by, scan_ends ends) {
                     return mark_veiling(all, {by.edge_window, by.least_angle_deg}, ends);
                   });
}

void g4lidar_near_options_init(g4lidar_near_options* options, size_t size) {
  set_defaults(options, size, near_defaults);
}

int g4lidar_mark_near(g4lidar_point* points, size_t count, g4lidar_near_history* history,
                      const g4lidar_near_options* options, size_t* marked) {
  const auto limits = near_of(options);
  if ((count > 0 && points == nullptr) || history == nullptr || !limits) {
    return G4LIDAR_BAD_ARGUMENT;
  }
  auto known = std::bit_cast<near_history>(*history);
  const std::size_t found = mark_near(points_of(points, count), known, *limits);
  *history = std::bit_cast<g4lidar_near_history>(known);
  if (marked != nullptr) *marked = found;
  return G4LIDAR_OK;
}

int g4lidar_mask_parse(const char* text, g4lidar_mask** made, g4lidar_error* error) {
  return created(
      made, error,
      [&] {
        auto read = parse_mask(text);
        if (const auto* wrong = std::get_if<mask_error>(&read)) {
          return bad_text(error, wrong->line, wrong->message);
        }
        auto parsed = std::make_unique<g4lidar_mask>();
        parsed->made = std::get<mask>(std::move(read));
        for (const polygon& each : parsed->made.polygons()) {
          parsed->polygons.push_back(
              {reinterpret_cast<const g4lidar_corner*>(each.data()), each.size()});
        }
        *made = parsed.release();
        return succeed(error);
      },
      text);
}

const g4lidar_polygon* g4lidar_mask_polygons(const g4lidar_mask* mask, size_t* count) {
  if (mask == nullptr || count == nullptr) return nullptr;
  *count = mask->polygons.size();
  return mask->polygons.data();
}

void g4lidar_mask_free(g4lidar_mask* mask) { delete mask; }
