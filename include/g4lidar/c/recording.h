/* SPDX-License-Identifier: MIT */
/**
 * @file
 * Recordings: written while a lidar is read, played as a lidar, and read item by item. MCAP files;
 * docs/recordings.md describes them.
 */
#ifndef G4LIDAR_C_RECORDING_H
#define G4LIDAR_C_RECORDING_H

#include "g4lidar/c/filter.h"
#include "g4lidar/c/lidar.h"
#include "g4lidar/c/motion.h"

#ifdef __cplusplus
extern "C" {
#endif

/** How a recording is written. A text that is NULL has its default. */
typedef struct g4lidar_recorder_options {
  size_t struct_size;            /**< Set by g4lidar_recorder_options_init(). */
  const char* topic;             /**< Of the LaserScan messages; "/scan". */
  const char* frame_id;          /**< Of the messages of scans and points; "laser". */
  const char* points_topic;      /**< Of PointCloud2 messages; NULL: none are written. */
  const g4lidar_mounting* mount; /**< How the lidar is fixed to the robot; NULL: not known. */
  /** Begin a new file before one becomes larger, at least 1048576; 0: never. It has the next free number. */
  uint64_t rotate_bytes;
  int32_t rotate_s;   /**< The same for its duration in seconds; 0: never. */
  int32_t chunk_ms;   /**< A crash loses at most this much, 10 to 10000; 500. */
  uint32_t scan_bins; /**< Ranges in each LaserScan, 1 to 65536; 0, g4lidar_scan::default_bins. */
  bool compressed;    /**< Whether zstd is used; see g4lidar_has_feature(). */
  bool
      overwrite; /**< Whether an existing file may be replaced, when there is something to write. */
  bool without_scans;  /**< Write no LaserScan messages: only bytes. */
  uint8_t reserved[1]; /**< 0. */
  int32_t no_return; /**< Of a LaserScan: a g4lidar_no_return_as; G4LIDAR_NO_RETURN_AS_INFINITY. */
  int32_t near_is_minus_infinity; /**< As in g4lidar_grid_options; 0. */
  /** Whether the points of a LaserScan are flagged as a shaper with `near` does; NULL: they are not. */
  const g4lidar_near_options* near_options;
  /** The model that sends the bytes: "x4"; NULL: that of the first lidar that is recorded, else "g4". */
  const char* model;
} g4lidar_recorder_options;

/** Sets the defaults; `size` is sizeof(g4lidar_recorder_options). */
G4LIDAR_C_API void g4lidar_recorder_options_init(g4lidar_recorder_options* options, size_t size);

/** Creates the file `path`. `options` may be NULL. Fails with bad_option, or with system. */
G4LIDAR_C_API int g4lidar_recorder_create(const char* path, const g4lidar_recorder_options* options,
                                          g4lidar_recorder** recorder, g4lidar_error* error);
/** Ends the file, if it was not ended, and releases the recorder. A lidar that is recorded by it may
 *  live longer: it is not recorded any more. */
G4LIDAR_C_API void g4lidar_recorder_free(g4lidar_recorder* recorder);
/** Records odometry of the robot, by the clock of the points. */
G4LIDAR_C_API int g4lidar_recorder_odometry(g4lidar_recorder* recorder,
                                            const g4lidar_odometry* odometry);
/** Records bytes that a program received from a lidar (`to_device` false) or sent to it by itself, at
 *  a time of g4lidar_now_ns(). */
G4LIDAR_C_API int g4lidar_recorder_bytes(g4lidar_recorder* recorder, bool to_device,
                                         const uint8_t* data, size_t size, int64_t time_ns);
/** Passes everything to the system. May wait for the disk. */
G4LIDAR_C_API int g4lidar_recorder_flush(g4lidar_recorder* recorder, g4lidar_error* error);
/** Ends the file. After that nothing is recorded. May wait for the disk. */
G4LIDAR_C_API int g4lidar_recorder_close(g4lidar_recorder* recorder, g4lidar_error* error);
/** Why something could not be written, once for each failure: the disk is full. Recording continues when
 *  that is possible again. G4LIDAR_NOTHING without a failure. */
G4LIDAR_C_API int g4lidar_recorder_take_error(g4lidar_recorder* recorder, g4lidar_error* error);

/** Counts of a recorder, over all its files. */
typedef struct g4lidar_recorder_counts {
  uint64_t bytes_from_device; /**< Recorded. */
  uint64_t bytes_to_device;   /**< Recorded. */
  uint64_t scans;             /**< LaserScan messages. */
  uint64_t odometry;          /**< Odometry messages. */
  uint64_t files;             /**< Begun. */
  uint64_t file_bytes;        /**< Written to all of them. */
  uint64_t bytes_lost;        /**< In parts that could not be written. */
} g4lidar_recorder_counts;

/** The counts as they are now. */
G4LIDAR_C_API const g4lidar_recorder_counts* g4lidar_recorder_get_counts(
    g4lidar_recorder* recorder);

/** How a recording is played. */
typedef struct g4lidar_playback_options {
  size_t struct_size;  /**< Set by g4lidar_playback_options_init(). */
  double speed;        /**< 1: as fast as it was recorded; 0, the default: as fast as it is read. */
  int64_t from_ns;     /**< Only what was recorded from here on, since its beginning; 0. */
  int64_t to_ns;       /**< And before this; 0: to its end. */
  bool loop;           /**< Whether it begins again at its end; times continue. */
  uint8_t reserved[7]; /**< 0. */
  /** As in g4lidar_reader_options; g4lidar_wake() does the same once the lidar is open. NULL: that of the
   *  g4lidar_options. */
  bool (*is_cancelled)(void* context);
  void* context; /**< Passed to it. */
} g4lidar_playback_options;

/** Sets the defaults; `size` is sizeof(g4lidar_playback_options). */
G4LIDAR_C_API void g4lidar_playback_options_init(g4lidar_playback_options* options, size_t size);

/** Opens a recording as a lidar: the same points as from the recorded one; player.h controls it. It ends
 *  with G4LIDAR_END_OF_INPUT. `playback` and `options` may be NULL; `device` of the options is not used. */
G4LIDAR_C_API int g4lidar_open_recording(const char* path, const g4lidar_playback_options* playback,
                                         const g4lidar_options* options, g4lidar_lidar** lidar,
                                         g4lidar_error* error);

/** What is known about a file and its damage, as far as it was read. */
typedef struct g4lidar_recording_info {
  int64_t first_ns;       /**< The time of its first item, by the clock of the recording. */
  int64_t last_ns;        /**< The time of the last one that can be read. */
  uint64_t size;          /**< Of the file, in bytes. */
  uint64_t position;      /**< In the file, in bytes: for a progress bar. */
  uint64_t bytes_skipped; /**< Damaged bytes of the file. */
  uint64_t chunks_lost;   /**< Parts whose contents are damaged. */
  bool is_cut_off;   /**< It has no proper end: the program was killed, or the disk was full. */
  bool has_identity; /**< Whether the recorded lidar is known: `identity`. */
  g4lidar_identity identity; /**< Of the recorded lidar. */
  const char* model;         /**< The word of its model: "g4". Valid forever. */
} g4lidar_recording_info;

/** Of a lidar that plays a recording; NULL for another one. */
G4LIDAR_C_API const g4lidar_recording_info* g4lidar_playback_info(g4lidar_lidar* lidar);

/** Whether the file at `path` begins like a recording. False if it cannot be read. */
G4LIDAR_C_API bool g4lidar_is_recording(const char* path);

/** Opens a recording for reading. Fails with bad_file, or with system. */
G4LIDAR_C_API int g4lidar_reader_open(const char* path, g4lidar_reader** reader,
                                      g4lidar_error* error);

/** How a recording is read. */
typedef struct g4lidar_reader_options {
  size_t struct_size; /**< Set by g4lidar_reader_options_init(). */
  /** Called often while a function searches the file, which may take long if the file is damaged or
   *  hostile; returning true ends that function with G4LIDAR_CANCELLED, and the next call continues.
   *  NULL: never. It must not use the reader, nor throw C++ exceptions. */
  bool (*is_cancelled)(void* context);
  void* context;       /**< Passed to it; it outlives the reader. */
  uint8_t reserved[8]; /**< 0. */
} g4lidar_reader_options;

/** Sets the defaults; `size` is sizeof(g4lidar_reader_options). */
G4LIDAR_C_API void g4lidar_reader_options_init(g4lidar_reader_options* options, size_t size);

/** Like g4lidar_reader_open(), with options, which may be NULL. Fails also with cancelled; then there
 *  is no reader. */
G4LIDAR_C_API int g4lidar_reader_open_with(const char* path, const g4lidar_reader_options* options,
                                           g4lidar_reader** reader, g4lidar_error* error);
/** Releases a reader. */
G4LIDAR_C_API void g4lidar_reader_free(g4lidar_reader* reader);

/** The kinds of recorded item. */
enum g4lidar_item_kind {
  G4LIDAR_ITEM_FROM_DEVICE = 1, /**< `data` was read in one call. */
  G4LIDAR_ITEM_TO_DEVICE = 2,   /**< `data` was sent. */
  G4LIDAR_ITEM_EVENT = 3,       /**< `event_name`. */
  G4LIDAR_ITEM_ODOMETRY = 4     /**< `odometry`; its time may be before that of the item before. */
};

/** One recorded item. A view, valid until the next call with its reader. */
typedef struct g4lidar_item {
  int64_t time_ns;           /**< By the clock of the recording. */
  int64_t wall_ns;           /**< The same by the wall clock, nanoseconds since 1970. */
  const uint8_t* data;       /**< Bytes of the connection. */
  size_t size;               /**< Their number. */
  const char* event_name;    /**< "opened", "closed", "gap", ...; empty for other items. */
  g4lidar_odometry odometry; /**< Of the robot. */
  int32_t kind;              /**< A g4lidar_item_kind. */
} g4lidar_item;

/** The next item; G4LIDAR_END_OF_INPUT at the end. Damaged parts are left out; there is an event "gap". */
G4LIDAR_C_API int g4lidar_reader_next(g4lidar_reader* reader, const g4lidar_item** item,
                                      g4lidar_error* error);
/** The next item will be the first one from `from_ns` on, nanoseconds since the beginning of the
 *  recording. After a failure the reader is where it was. */
G4LIDAR_C_API int g4lidar_reader_seek(g4lidar_reader* reader, int64_t from_ns,
                                      g4lidar_error* error);
/** What is known about the file. */
G4LIDAR_C_API const g4lidar_recording_info* g4lidar_reader_info(g4lidar_reader* reader);

#ifdef __cplusplus
}
#endif

#endif
