/* SPDX-License-Identifier: MIT */
/**
 * @file
 * A simulated lidar: on a pseudo-terminal in real time, for any program that opens serial ports; or in
 * virtual time, for tests in which waiting costs no time. docs/sim.md describes worlds and faults.
 */
#ifndef G4LIDAR_C_SIMULATOR_H
#define G4LIDAR_C_SIMULATOR_H

#include "g4lidar/c/lidar.h"
#include "g4lidar/c/motion.h"

#ifdef __cplusplus
extern "C" {
#endif

/** What is simulated. */
typedef struct g4lidar_simulator_options {
  size_t struct_size; /**< Set by g4lidar_simulator_options_init(). */
  /** "sim:?NAME=VALUE&NAME=VALUE": seed, faults, files of world and path, ...; NULL: a healthy lidar. */
  const char* setup;
  const char* world; /**< The text of a world; NULL: that of `setup`, or the built-in rooms. */
  const char* path; /**< The text of the path of a robot; NULL: that of `setup`, or of the world. */
  const char* link; /**< In real time: a symbolic link to the port; NULL: in a new directory. */
  bool virtual_time; /**< Whether time passes only in calls of g4lidar_open_simulated()'s lidars. */
  uint8_t reserved[7]; /**< 0. */
} g4lidar_simulator_options;

/** Sets the defaults; `size` is sizeof(g4lidar_simulator_options). */
G4LIDAR_C_API void g4lidar_simulator_options_init(g4lidar_simulator_options* options, size_t size);

/** Creates a lidar. In real time a thread of the library serves it, until g4lidar_simulator_free().
 *  `options` may be NULL. Fails with bad_option, bad_file (the message has the line of the text), busy
 *  (another one is at the link), system. */
G4LIDAR_C_API int g4lidar_simulator_create(const g4lidar_simulator_options* options,
                                           g4lidar_simulator** simulator, g4lidar_error* error);
/** Releases a simulator: its port disappears, as after an unplug. A lidar that was opened with
 *  g4lidar_open_simulated() may live longer. */
G4LIDAR_C_API void g4lidar_simulator_free(g4lidar_simulator* simulator);

/** The path of its port; empty in virtual time. Valid as long as the simulator. */
G4LIDAR_C_API const char* g4lidar_simulator_path(const g4lidar_simulator* simulator);
/** Opens it, in either time; `options` may be NULL, and their `device` is not used. `model` NULL: that of the
 *  simulator. In virtual time
 *  the lidar and its simulator belong to one thread. */
G4LIDAR_C_API int g4lidar_open_simulated(g4lidar_simulator* simulator,
                                         const g4lidar_options* options, g4lidar_lidar** lidar,
                                         g4lidar_error* error);

/** Unplugs it. */
G4LIDAR_C_API int g4lidar_simulator_unplug(g4lidar_simulator* simulator);
/** Plugs it in again. */
G4LIDAR_C_API int g4lidar_simulator_replug(g4lidar_simulator* simulator);
/** Lets `duration_ns` of virtual time pass. G4LIDAR_BAD_ARGUMENT in real time, or below 0. */
G4LIDAR_C_API int g4lidar_simulator_advance(g4lidar_simulator* simulator, int64_t duration_ns);

/** The state of a simulated lidar. */
typedef struct g4lidar_simulator_state {
  int64_t time_ns;          /**< Since it was created. */
  uint64_t bytes_delivered; /**< Bytes that reached the host or were lost because it was slow. */
  uint64_t replugs;         /**< How often it was plugged in again. */
  float motor_hz;           /**< The true speed of the head. */
  bool is_plugged;          /**< Whether the host sees the port. */
  bool is_scanning;         /**< Whether it was started and not stopped. */
  bool motor_turns;         /**< Whether the motor is powered. */
} g4lidar_simulator_state;

/** The state now. Valid until the next call of this function. */
G4LIDAR_C_API const g4lidar_simulator_state* g4lidar_simulator_get_state(
    g4lidar_simulator* simulator);

/** The true values of a sample that was sent. */
typedef struct g4lidar_truth {
  int64_t time_ns;     /**< When it was measured, since the simulator was created. */
  double head_deg;     /**< The angle of the head, clockwise, [0, 360). */
  double bearing_deg;  /**< The direction of the target, as g4lidar_point::angle_deg. */
  double range_mm;     /**< Of the target, without noise; 0: there is none. */
  double x_m;          /**< Of the lidar in its world. */
  double y_m;          /**< Of the lidar in its world. */
  double heading_deg;  /**< Of the lidar's angle 0, counter-clockwise; not wrapped. */
  uint64_t revolution; /**< From 0. */
} g4lidar_truth;

/** Takes the oldest samples that were not taken yet, at most `room`, and their number in `count`. At
 *  most 16,384 are kept. */
G4LIDAR_C_API int g4lidar_simulator_take_truth(g4lidar_simulator* simulator, g4lidar_truth* truth,
                                               size_t room, size_t* count);

/** The next odometry of the robot that carries the lidar, without errors, 50 times a second, by the
 *  clock of the points. G4LIDAR_NOTHING if that time has not come, or if there is no robot. */
G4LIDAR_C_API int g4lidar_simulator_next_odometry(g4lidar_simulator* simulator,
                                                  g4lidar_odometry* odometry);

#ifdef __cplusplus
}
#endif

#endif
