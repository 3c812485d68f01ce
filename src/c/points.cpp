// SPDX-License-Identifier: MIT
// Points, grids and masks: the functions of the core for the memory of the caller.
#include <g4lidar/c/filter.h>
#include <g4lidar/c/point.h>

#include <memory>
#include <variant>
#include <vector>

#include "border.hpp"
#include "g4lidar/cartesian.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/options/filter_text.hpp"
#include "ranges.hpp"

using namespace g4lidar;
using namespace g4lidar::c;

struct g4lidar_mask {
  mask made;
  std::vector<g4lidar_polygon> polygons;
};

int g4lidar_to_xy(const g4lidar_point* points, size_t count, int frame, unsigned turn_deg,
                  g4lidar_xy* out) {
  if (!is_frame(frame) || !is_turn(turn_deg) ||
      (count > 0 && (points == nullptr || out == nullptr))) {
    return G4LIDAR_BAD_ARGUMENT;
  }
  to_xy(points_of(points, count), frame_of(frame), {reinterpret_cast<xy_point*>(out), count},
        static_cast<std::uint16_t>(turn_deg));
  return G4LIDAR_OK;
}

int g4lidar_to_polar(const g4lidar_point* points, size_t count, int frame, unsigned turn_deg,
                     g4lidar_polar* out) {
  if (!is_frame(frame) || !is_turn(turn_deg) ||
      (count > 0 && (points == nullptr || out == nullptr))) {
    return G4LIDAR_BAD_ARGUMENT;
  }
  to_polar(points_of(points, count), frame_of(frame), {reinterpret_cast<polar*>(out), count},
           static_cast<std::uint16_t>(turn_deg));
  return G4LIDAR_OK;
}

void g4lidar_grid_options_init(g4lidar_grid_options* options, size_t size) {
  set_defaults(options, size, grid_defaults);
}

int g4lidar_grid_options_set_model(g4lidar_grid_options* options, const char* model) {
  const g4lidar::model* of = &g4_model;
  g4lidar_grid_options taken = grid_defaults;
  if (options == nullptr || !take_options(options, taken) || !take_model(model, of)) {
    return G4LIDAR_BAD_ARGUMENT;
  }
  constexpr std::size_t end =
      offsetof(g4lidar_grid_options, longest_range_mm) + sizeof options->longest_range_mm;
  if (options->struct_size < end) return G4LIDAR_BAD_ARGUMENT;
  options->turn_deg = of->turn_deg;
  options->longest_range_mm = of->range.max_mm;
  return G4LIDAR_OK;
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

void g4lidar_outlier_options_init(g4lidar_outlier_options* options, size_t size) {
  set_defaults(options, size, outlier_defaults);
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
