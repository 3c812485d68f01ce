/* SPDX-License-Identifier: MIT */
/**
 * @file
 * Scans that are marked, filtered and deskewed: each product is made once, and only if it is taken. One thread at
 * a time may use a shaper.
 */
#ifndef G4LIDAR_C_SHAPER_H
#define G4LIDAR_C_SHAPER_H

#include "g4lidar/c/filter.h"
#include "g4lidar/c/motion.h"

#ifdef __cplusplus
extern "C" {
#endif

/** How a shaper knows the motion by which it deskews. */
enum g4lidar_deskewing {
  G4LIDAR_DESKEW_NONE = 0, /**< It does not deskew. */
  /** From the poses of the robot, its odometry. Between two poses the twist is constant. */
  G4LIDAR_DESKEW_BY_PATH = 1,
  G4LIDAR_DESKEW_BY_SCANS = 2 /**< From the scans alone, as g4lidar_estimator_add_of_model(). */
};

/** What a shaper does. By default it changes nothing. What is NULL is not done. */
typedef struct g4lidar_shaper_options {
  size_t struct_size;                       /**< Set by g4lidar_shaper_options_init(). */
  const g4lidar_filter_options* filter;     /**< Which points are kept. */
  const g4lidar_outlier_options* speckle;   /**< Leaves out isolated returns. */
  const g4lidar_outlier_options* edges;     /**< Leaves out points between two surfaces. */
  const g4lidar_near_options* near_options; /**< Flags G4LIDAR_MAY_BE_TOO_NEAR. */
  const g4lidar_mounting* mount; /**< Of the lidar on the robot, for G4LIDAR_DESKEW_BY_PATH. */
  int32_t deskew;                /**< A g4lidar_deskewing; none. */
  bool restamps;       /**< Whether deskewed points get the time to which they were deskewed. */
  uint8_t reserved[3]; /**< 0. */
  const char* model;   /**< g4lidar_scan::model of the lidar; NULL: a G4. */
} g4lidar_shaper_options;

/** Sets the defaults; `size` is sizeof(g4lidar_shaper_options). */
G4LIDAR_C_API void g4lidar_shaper_options_init(g4lidar_shaper_options* options, size_t size);

/** Marks, filters and deskews the scans of one lidar. */
typedef struct g4lidar_shaper g4lidar_shaper;

/** Creates a shaper. Copies what the options refer to; NULL: the defaults. Fails with bad_argument. */
G4LIDAR_C_API int g4lidar_shaper_create(const g4lidar_shaper_options* options,
                                        g4lidar_shaper** shaper, g4lidar_error* error);

/** Takes the next scan of the lidar, in order: its points, whether they are a piece of a revolution, and for
 *  G4LIDAR_DESKEW_BY_PATH the poses of the robot, times ascending. Both arrays must not change until the next
 *  call. Call it for each scan, although nobody may take its points. Allocates for the first scans. */
G4LIDAR_C_API int g4lidar_shaper_shape(g4lidar_shaper* shaper, const g4lidar_point* points,
                                       size_t count, bool is_piece,
                                       const g4lidar_stamped_pose* path, size_t path_count);

/** The points that are kept, and their number in `count`. Deskewed points are where they would have been seen at
 *  the time of the scan's first point. Made by the first call, and valid until the next
 *  g4lidar_shaper_shape(). NULL if there is no memory. */
G4LIDAR_C_API const g4lidar_point* g4lidar_shaper_kept(g4lidar_shaper* shaper, size_t* count);

/** The same for g4lidar_fill_grid(): a return that is left out stays and is flagged G4LIDAR_TOO_NEAR, so that its
 *  bin becomes NaN and not free; points without return stay. Points that `speckle` and `edges` leave out are
 *  also flagged G4LIDAR_ISOLATED and G4LIDAR_VEILING. */
G4LIDAR_C_API const g4lidar_point* g4lidar_shaper_for_grid(g4lidar_shaper* shaper, size_t* count);

/** How many points of the scan, kept or not, have no known motion. They stay where they are, flagged
 *  G4LIDAR_NOT_DESKEWED. 0 if it does not deskew. */
G4LIDAR_C_API size_t g4lidar_shaper_outside(const g4lidar_shaper* shaper);

/** Releases a shaper. */
G4LIDAR_C_API void g4lidar_shaper_free(g4lidar_shaper* shaper);

#ifdef __cplusplus
}
#endif

#endif
