/* SPDX-License-Identifier: MIT */
/**
 * @file
 * The C interface of libg4lidar, for C99, C++ and every language that can call C: the library
 * `libg4lidar_c`. docs/c.md describes it.
 *
 *     g4lidar_lidar* lidar;
 *     const g4lidar_scan* scan;
 *     g4lidar_error error;
 *     if (g4lidar_open("", &lidar, &error) || g4lidar_start(lidar, &error)) return report(&error);
 *     while (!g4lidar_wait_scan(lidar, 500, &scan, &error)) use(scan->points, scan->point_count);
 *     g4lidar_free(lidar);
 */
#ifndef G4LIDAR_H
#define G4LIDAR_H

#include "g4lidar/c/base.h"
#include "g4lidar/c/discovery.h"
#include "g4lidar/c/filter.h"
#include "g4lidar/c/lidar.h"
#include "g4lidar/c/motion.h"
#include "g4lidar/c/player.h"
#include "g4lidar/c/point.h"
#include "g4lidar/c/recording.h"
#include "g4lidar/c/shaper.h"
#include "g4lidar/c/simulator.h"

#endif
