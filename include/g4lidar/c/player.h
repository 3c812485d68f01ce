/* SPDX-License-Identifier: MIT */
/**
 * @file
 * How a lidar plays a file, and a thread that reads a lidar, so that the program need not call it in
 * time.
 */
#ifndef G4LIDAR_C_PLAYER_H
#define G4LIDAR_C_PLAYER_H

#include "g4lidar/c/lidar.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Where the player of a file is, and how it plays. Positions are nanoseconds since the beginning of the
 *  file. */
typedef struct g4lidar_playback {
  int64_t length_ns;   /**< From the first to the last byte of the file. */
  int64_t position_ns; /**< In the round that is played. */
  int64_t begin_ns;    /**< The time of position 0, as that of a point of this round. */
  double speed;        /**< As in g4lidar_playback_options. */
  bool is_paused;      /**< By g4lidar_pause(). */
} g4lidar_playback;

/** Of a lidar that plays a recording, or raw bytes in a file; NULL for another one. Valid until the next
 *  call of this function. The length of raw bytes is searched in the file, the first time. */
G4LIDAR_C_API const g4lidar_playback* g4lidar_get_playback(g4lidar_lidar* lidar);
/** While it is paused nothing is read: g4lidar_try_scan() waits until its timeout,
 *  g4lidar_wait_scan() without limit. This and the functions below fail with G4LIDAR_BAD_ARGUMENT for a
 *  lidar that plays no file. */
G4LIDAR_C_API int g4lidar_pause(g4lidar_lidar* lidar, bool pauses, g4lidar_error* error);
/** From now on: 1: as fast as it was recorded; 0: as fast as it is read; else 0.000001 to 1000. Fails also
 *  with bad_option. */
G4LIDAR_C_API int g4lidar_set_speed(g4lidar_lidar* lidar, double speed, g4lidar_error* error);
/** Whether it begins again at its end; times continue. */
G4LIDAR_C_API int g4lidar_set_loop(g4lidar_lidar* lidar, bool loops, g4lidar_error* error);
/** Continues at another place, also after the end; a place outside of the file is its beginning or its
 *  end. A scan that was started runs on, the unfinished revolution is dropped, and counts go on. Fails also
 *  with bad_option for a lidar with a recorder, and as g4lidar_reader_open(). */
G4LIDAR_C_API int g4lidar_seek(g4lidar_lidar* lidar, int64_t from_ns, g4lidar_error* error);

/** A thread that reads a lidar. */
typedef struct g4lidar_background g4lidar_background;

/** What the thread does. */
enum g4lidar_background_state {
  G4LIDAR_RUNNING = 2, /**< Scans come, or will come when the motor has spun up. */
  G4LIDAR_RESTING = 3, /**< The motor stands. */
  G4LIDAR_LOST = 4,    /**< Unplugged: the lidar is looked for. */
  G4LIDAR_ENDED = 5    /**< No more scans follow, unless a file is continued by a seek. */
};

/** Starts the scan, and a thread that reads it. It takes the lidar over: every other function then
 *  fails for that handle, and g4lidar_free() releases it, before or after this. With `newest_only` only
 *  the newest scan is kept; else the last four. Fails as g4lidar_start(), which closes the lidar, and with
 *  G4LIDAR_BAD_ARGUMENT for a simulator in virtual time, and for a lidar with a recorder. */
G4LIDAR_C_API int g4lidar_background_start(g4lidar_lidar* lidar, bool newest_only,
                                           g4lidar_background** reader, g4lidar_error* error);
/** Ends the thread, stops the motor and closes the lidar. Not in `is_cancelled`. */
G4LIDAR_C_API void g4lidar_background_free(g4lidar_background* reader);
/** The oldest scan that is kept and was not taken yet; valid until the next call. Older ones are counted
 *  as `scans_missed`. Fails with G4LIDAR_TIMEOUT; when the thread has ended, with the reason. One thread at a
 *  time calls this and the other functions of a reader that return pointers; those that return none may be
 *  called by any thread, and in `is_cancelled`, which the thread of the reader calls. */
G4LIDAR_C_API int g4lidar_background_next_scan(g4lidar_background* reader, int timeout_ms,
                                               const g4lidar_scan** scan, g4lidar_error* error);
/** A g4lidar_background_state; 0 for NULL. */
G4LIDAR_C_API int g4lidar_background_get_state(const g4lidar_background* reader);
/** As g4lidar_next_event(). */
G4LIDAR_C_API int g4lidar_background_next_event(g4lidar_background* reader, g4lidar_event* event);
/** As g4lidar_get_counts(); at most 0.1 s old while points arrive. */
G4LIDAR_C_API const g4lidar_counts* g4lidar_background_get_counts(g4lidar_background* reader);
/** As g4lidar_get_playback(), without `begin_ns`, which is 0. */
G4LIDAR_C_API const g4lidar_playback* g4lidar_background_get_playback(g4lidar_background* reader);
/** Whether the motor is to stand. A file, too, is not read while it rests. */
G4LIDAR_C_API int g4lidar_background_rest(g4lidar_background* reader, bool rests);
/** Pauses the player of a file; a seek then gives one scan. Ignored for other lidars, as are the functions
 *  below. */
G4LIDAR_C_API int g4lidar_background_pause(g4lidar_background* reader, bool pauses);
/** As g4lidar_set_speed(). */
G4LIDAR_C_API int g4lidar_background_set_speed(g4lidar_background* reader, double speed,
                                               g4lidar_error* error);
/** Continues there, at most at one second before the end, in a file. Also after its end. */
G4LIDAR_C_API int g4lidar_background_seek(g4lidar_background* reader, int64_t from_ns);

#ifdef __cplusplus
}
#endif

#endif
