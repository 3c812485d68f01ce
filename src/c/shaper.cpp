// SPDX-License-Identifier: MIT
// Shaped scans.
#include <g4lidar/c/shaper.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "border.hpp"
#include "g4lidar/options/filter_text.hpp"
#include "g4lidar/scan_shaper.hpp"
#include "motion_values.hpp"
#include "ranges.hpp"

using namespace g4lidar;
using namespace g4lidar::c;

struct g4lidar_shaper {
  scan_shaper made;
  const model* of;
};

namespace {

constexpr g4lidar_filter_options filter_defaults{sizeof(g4lidar_filter_options),
                                                 nullptr,
                                                 0,
                                                 nullptr,
                                                 0,
                                                 {0.0, 360.0},
                                                 0.0F,
                                                 std::numeric_limits<float>::infinity(),
                                                 G4LIDAR_VENDOR,
                                                 0,
                                                 false,
                                                 false,
                                                 {}};
constexpr g4lidar_shaper_options shaper_defaults{sizeof(g4lidar_shaper_options),
                                                 nullptr,
                                                 nullptr,
                                                 nullptr,
                                                 nullptr,
                                                 nullptr,
                                                 G4LIDAR_DESKEW_NONE,
                                                 false,
                                                 {},
                                                 nullptr};

/// The filter of the options, and the memory of what it views.
class taken_filter {
 public:
  /// Whether the options can be used.
  [[nodiscard]] bool take(const g4lidar_filter_options* given) {
    g4lidar_filter_options options = filter_defaults;
    if (!take_options(given, options) || !is_frame(options.frame)) return false;
    if ((options.ignored_sectors == nullptr && options.ignored_sector_count > 0) ||
        options.mask_count > max_mask_polygons ||
        (options.masks == nullptr && options.mask_count > 0) || options.excluded_flags > 0xFF) {
      return false;
    }
    for (std::size_t i = 0; i < options.ignored_sector_count; ++i) {
      sectors_.emplace_back(options.ignored_sectors[i].from_deg, options.ignored_sectors[i].to_deg);
    }
    for (std::size_t i = 0; i < options.mask_count; ++i) {
      const g4lidar_polygon& each = options.masks[i];
      if (each.corners == nullptr && each.count > 0) return false;
      masks_.emplace_back(reinterpret_cast<const corner*>(each.corners), each.count);
    }
    filter_ = {.in = frame_of(options.frame),
               .field_of_view = {options.field_of_view.from_deg, options.field_of_view.to_deg},
               .ignored_sectors = sectors_,
               .masks = masks_,
               .least_range_mm = options.least_range_mm,
               .greatest_range_mm = options.greatest_range_mm,
               .returns_only = options.returns_only,
               .trusted_only = options.trusted_only,
               .excluded = static_cast<point_flags>(options.excluded_flags)};
    return true;
  }
  [[nodiscard]] const point_filter& filter() const noexcept { return filter_; }

 private:
  std::vector<sector> sectors_;
  std::vector<polygon> masks_;
  point_filter filter_;
};

/// Nothing if a member has no valid value. Views `filter`.
std::optional<shaping_options> shaping_of(const g4lidar_shaper_options& taken,
                                          taken_filter& filter) {
  const auto speckle = outliers_of(taken.speckle);
  const auto edges = outliers_of(taken.edges);
  const auto near = near_of(taken.near_options);
  const bool is_placed =
      taken.mount == nullptr || (is_usable(taken.mount->pose) && has_known_members(*taken.mount));
  if (!speckle || !edges || !near || !is_placed || !filter.take(taken.filter) ||
      taken.deskew < G4LIDAR_DESKEW_NONE || taken.deskew > G4LIDAR_DESKEW_BY_SCANS) {
    return std::nullopt;
  }
  shaping_options made{.filter = filter.filter(),
                       .deskew = static_cast<deskewing>(taken.deskew),
                       .mount = taken.mount == nullptr ? mounting{} : mounting_of(*taken.mount),
                       .restamps = taken.restamps};
  if (taken.speckle != nullptr) made.marks.speckle = speckle->speckle;
  if (taken.edges != nullptr) made.marks.edges = edges->edges;
  if (taken.near_options != nullptr) made.marks.near = *near;
  return made;
}

template <class Take>
const g4lidar_point* taken_points(g4lidar_shaper* shaper, std::size_t* count, Take take) noexcept {
  if (shaper == nullptr || count == nullptr) return nullptr;
  try {
    const std::span<const point> points = take(shaper->made).points;
    *count = points.size();
    return reinterpret_cast<const g4lidar_point*>(points.data());
  } catch (const std::bad_alloc&) {
    *count = 0;
    return nullptr;
  }
}

}  // namespace

void g4lidar_filter_options_init(g4lidar_filter_options* options, size_t size) {
  set_defaults(options, size, filter_defaults);
}

void g4lidar_near_options_init(g4lidar_near_options* options, size_t size) {
  set_defaults(options, size, near_defaults);
}

void g4lidar_shaper_options_init(g4lidar_shaper_options* options, size_t size) {
  set_defaults(options, size, shaper_defaults);
}

int g4lidar_shaper_create(const g4lidar_shaper_options* options, g4lidar_shaper** shaper,
                          g4lidar_error* error) {
  return created(shaper, error, [&] {
    g4lidar_shaper_options taken = shaper_defaults;
    if (!take_options(options, taken)) return refuse(error, bad_options);
    taken_filter filter;
    const auto how = shaping_of(taken, filter);
    const model* const of = taken.model == nullptr ? &g4_model : model_named(taken.model);
    if (!how || of == nullptr) return refuse(error, "an option of the shaper has no valid value");
    *shaper = new g4lidar_shaper{scan_shaper(*how), of};
    return succeed(error);
  });
}

int g4lidar_shaper_shape(g4lidar_shaper* shaper, const g4lidar_point* points, size_t count,
                         bool is_piece, const g4lidar_stamped_pose* path, size_t path_count) {
  const auto poses = path_of(path, path_count);
  if (shaper == nullptr || (count > 0 && points == nullptr) || !poses) return G4LIDAR_BAD_ARGUMENT;
  scan source;
  source.points = points_of(points, count);
  source.model = shaper->of;
  if (is_piece) source.flags = scan_flags::end_missing;
  return guarded(nullptr, [&] {
    shaper->made.shape(source, *poses);
    return static_cast<int>(G4LIDAR_OK);
  });
}

const g4lidar_point* g4lidar_shaper_kept(g4lidar_shaper* shaper, size_t* count) {
  return taken_points(shaper, count, [](scan_shaper& made) { return made.kept(); });
}

const g4lidar_point* g4lidar_shaper_for_grid(g4lidar_shaper* shaper, size_t* count) {
  return taken_points(shaper, count, [](scan_shaper& made) { return made.for_grid(); });
}

size_t g4lidar_shaper_outside(const g4lidar_shaper* shaper) {
  return shaper == nullptr ? 0 : shaper->made.outside();
}

void g4lidar_shaper_free(g4lidar_shaper* shaper) { delete shaper; }
