/* SPDX-License-Identifier: MIT */
/**
 * @file
 * Motion in the plane, and how a lidar moves, from its scans alone. As in REP 103: x and y in metres, yaw
 * counter-clockwise in radians. The layouts of these structures do not change.
 */
#ifndef G4LIDAR_C_MOTION_H
#define G4LIDAR_C_MOTION_H

#include "g4lidar/c/point.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A position and a heading in the plane. */
typedef struct g4lidar_pose {
  double x_m;     /**< Metres. */
  double y_m;     /**< Metres. */
  double yaw_rad; /**< Counter-clockwise from the x axis; at most 1e6 in magnitude. */
} g4lidar_pose;

/** A velocity in the moving frame: x forward, y to the left. */
typedef struct g4lidar_twist {
  double x_m_per_s;     /**< Forward. */
  double y_m_per_s;     /**< To the left. */
  double yaw_rad_per_s; /**< Counter-clockwise. */
} g4lidar_twist;

/** A pose at a time of the monotonic clock. */
typedef struct G4LIDAR_C_SHARED g4lidar_stamped_pose {
  int64_t time_ns;   /**< As in points. */
  g4lidar_pose pose; /**< In a fixed frame. */
} g4lidar_stamped_pose;

/** The pose of a robot in a fixed frame, and its velocity in its own frame. */
typedef struct g4lidar_odometry {
  int64_t time_ns;     /**< As in points. */
  g4lidar_pose pose;   /**< In a fixed frame. */
  g4lidar_twist twist; /**< In the frame of the robot. */
} g4lidar_odometry;

/** How a lidar is fixed to a robot. */
typedef struct g4lidar_mounting {
  g4lidar_pose pose; /**< The place of the lidar's frame G4LIDAR_ROBOT in the frame of the robot. */
  bool upside_down;  /**< Whether the lidar hangs with its top down. */
  uint8_t reserved[7]; /**< 0; else G4LIDAR_BAD_ARGUMENT. */
} g4lidar_mounting;

/** Estimates the motion of a lidar from its scans alone. */
typedef struct g4lidar_estimator g4lidar_estimator;

/** Whether a twist was estimated, or why not. */
enum g4lidar_twist_status {
  G4LIDAR_TWIST_KNOWN = 0,            /**< In all directions. */
  G4LIDAR_TWIST_DEGENERATE = 1,       /**< In some directions only: `known`. */
  G4LIDAR_TWIST_FIRST_SCAN = 2,       /**< There is no earlier scan to compare it with. */
  G4LIDAR_TWIST_NO_TIMES = 3,         /**< The times of a scan cannot be used. */
  G4LIDAR_TWIST_TOO_FEW_RETURNS = 4,  /**< One of the two scans has too few returns. */
  G4LIDAR_TWIST_LOST_REVOLUTION = 5,  /**< Half a revolution or more is missing between them. */
  G4LIDAR_TWIST_NO_CORRESPONDENCE = 6 /**< No twist moves one scan onto the other. */
};

/** The motion of a lidar during two revolutions. */
typedef struct g4lidar_twist_estimate {
  g4lidar_twist twist;  /**< Of the lidar's own frame G4LIDAR_ROBOT. */
  double covariance[9]; /**< Of x, y and yaw, row by row, in SI units. */
  uint8_t known[3];     /**< 1 where x, y and yaw are known. */
  uint8_t reserved[1];  /**< 0. */
  int32_t status;       /**< A g4lidar_twist_status. */
} g4lidar_twist_estimate;

/** Creates an estimator without scans. */
G4LIDAR_C_API int g4lidar_estimator_create(g4lidar_estimator** estimator, g4lidar_error* error);

/** The twist during the revolution before `points` and `points`, those of the next revolution in the
 *  order of measurement. `model`: g4lidar_scan::model; NULL: a G4. Never allocates. */
G4LIDAR_C_API int g4lidar_estimator_add_of_model(g4lidar_estimator* estimator,
                                                 const g4lidar_point* points, size_t count,
                                                 const char* model,
                                                 g4lidar_twist_estimate* estimate);

/** Releases an estimator. */
G4LIDAR_C_API void g4lidar_estimator_free(g4lidar_estimator* estimator);

#ifdef __cplusplus
}
#endif

#endif
