/* SPDX-License-Identifier: MIT */
/**
 * @file
 * Options of filters for g4lidar_shaper: ranges, directions, masks; isolated returns and veiling points. Any
 * thread may call the functions at any time.
 */
#ifndef G4LIDAR_C_FILTER_H
#define G4LIDAR_C_FILTER_H

#include "g4lidar/c/point.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The directions from one angle to another, degrees, in the sense in which the angles of the frame
 *  grow, both ends included: 350 to 10 is 20 degrees wide, 0 to 360 is every direction. */
typedef struct g4lidar_sector {
  double from_deg; /**< Any finite number of turns. */
  double to_deg;   /**< The same. */
} g4lidar_sector;

/** A corner of a polygon, in metres in G4LIDAR_ROBOT. */
typedef struct G4LIDAR_C_SHARED g4lidar_corner {
  float x_m; /**< Ahead. */
  float y_m; /**< To the left. */
} g4lidar_corner;

/** A polygon: its corners in order, at least three, in the memory of the caller. */
typedef struct g4lidar_polygon {
  const g4lidar_corner* corners; /**< The last one is joined to the first one. */
  size_t count;                  /**< Their number. */
} g4lidar_polygon;

/** Which points are kept: those that meet every condition. All by default. */
typedef struct g4lidar_filter_options {
  size_t struct_size;                    /**< Set by g4lidar_filter_options_init(). */
  const g4lidar_sector* ignored_sectors; /**< Points in one of them are left out; NULL: none. */
  size_t ignored_sector_count;           /**< Their number. */
  const g4lidar_polygon* masks; /**< Returns inside of one of them are left out; NULL: none. */
  size_t mask_count;            /**< Their number, at most 1000. */
  g4lidar_sector field_of_view; /**< Points in other directions are left out; 0 to 360. */
  float least_range_mm;         /**< Included; above 0 points without return are left out. */
  float greatest_range_mm;      /**< Included; +infinity. */
  int32_t frame;                /**< Of the sectors: a g4lidar_frame; G4LIDAR_VENDOR. */
  uint32_t excluded_flags;      /**< Points with one of these g4lidar_point_flag are left out; 0. */
  bool returns_only;            /**< Whether points without return are left out. */
  bool trusted_only;            /**< Whether points flagged G4LIDAR_TOO_NEAR are left out. */
  uint8_t reserved[6];          /**< 0. */
} g4lidar_filter_options;

/** Sets the defaults; `size` is sizeof(g4lidar_filter_options). */
G4LIDAR_C_API void g4lidar_filter_options_init(g4lidar_filter_options* options, size_t size);

/** Which returns are isolated (rain, dust, bit errors) or between two surfaces. */
typedef struct g4lidar_outlier_options {
  size_t struct_size;   /**< Set by g4lidar_outlier_options_init(). */
  uint32_t window;      /**< How many samples on each side are neighbours, 1 to 16; 2. */
  uint32_t near_count;  /**< Isolated: fewer near neighbours than this; 1. */
  float near_m;         /**< Near: up to this distance in metres, or up to; 0.05. */
  float near_ratio;     /**< this share of the range, if that is more; -1: by the angle
                             between samples, 0.05 up to 0.28 degrees. */
  uint32_t edge_window; /**< Veiling: how many samples on each side are neighbours; 1. */
  float
      least_angle_deg; /**< Veiling: below this angle to the beam a neighbour is across a jump of the
                            range; above 0, at most 45; 5. */
  uint8_t reserved[8]; /**< 0. */
} g4lidar_outlier_options;

/** Sets the defaults; `size` is sizeof(g4lidar_outlier_options). */
G4LIDAR_C_API void g4lidar_outlier_options_init(g4lidar_outlier_options* options, size_t size);

/** Which points without return are flagged G4LIDAR_MAY_BE_TOO_NEAR: in directions where, in the last revolutions,
 *  a return came from less than twice the shortest range, and none that is farther since. That misses some such
 *  targets, and has false alarms: <g4lidar/filter/too_near.hpp> has their numbers. */
typedef struct g4lidar_near_options {
  size_t struct_size; /**< Set by g4lidar_near_options_init(). */
  float
      shortest_mm; /**< A nearer target gives no return; 0: that of the model of a scan at its rate, 280 for a G4 at 9 kHz. */
  uint32_t
      revolutions; /**< For how many revolutions after a near return; 0: until a return comes; 3. */
  uint8_t reserved[8]; /**< 0. */
} g4lidar_near_options;

/** Sets the defaults; `size` is sizeof(g4lidar_near_options). */
G4LIDAR_C_API void g4lidar_near_options_init(g4lidar_near_options* options, size_t size);

/** Polygons that were read from a text. */
typedef struct g4lidar_mask g4lidar_mask;

/** Reads lines `polygon x1 y1 x2 y2 x3 y3 ...`, metres in G4LIDAR_ROBOT; `#` begins a comment. Fails
 *  with bad_file; the message has the number of the line. */
G4LIDAR_C_API int g4lidar_mask_parse(const char* text, g4lidar_mask** mask, g4lidar_error* error);

/** The polygons, for g4lidar_filter_options, and their number in `count`. Valid as long as the mask. */
G4LIDAR_C_API const g4lidar_polygon* g4lidar_mask_polygons(const g4lidar_mask* mask, size_t* count);

/** Releases a mask. */
G4LIDAR_C_API void g4lidar_mask_free(g4lidar_mask* mask);

#ifdef __cplusplus
}
#endif

#endif
