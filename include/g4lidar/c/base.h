/* SPDX-License-Identifier: MIT */
/**
 * @file
 * What every part of the C interface uses: results, errors, versions.
 *
 * Rules for all functions:
 *
 * - A function that can fail returns a g4lidar_result and fills the g4lidar_error that the caller
 *   places; NULL instead of it is allowed. Output arguments change only on success, except handles,
 *   which become NULL on failure.
 * - Other arguments must not be NULL unless their function allows it. Where one is NULL, the function
 *   returns G4LIDAR_BAD_ARGUMENT; a function without a g4lidar_result returns 0, NULL or -1, or does
 *   nothing.
 * - A handle belongs to one thread at a time, except where a function promises "any thread".
 *   Different handles are independent. A handle is released with the `_free` function of its type;
 *   releasing NULL does nothing. After that it must not be used.
 * - A pointer that a function returns is a view: it belongs to the handle, and is valid until the
 *   next call with the same handle unless the function promises more. Such structures may get more
 *   members at their end, so programs must not copy them by their size. Those that stand in arrays
 *   get none: g4lidar_point, g4lidar_polygon.
 * - A structure of options begins with its size. Its `_init` function sets the size and the default
 *   values. NULL instead of options means the default values. `reserved`, and a member that the
 *   library does not know, must be 0; else the function returns G4LIDAR_BAD_ARGUMENT.
 * - Members for an enumeration are integers of fixed size. Texts are UTF-8 and end with a zero byte.
 * - Nothing is printed, no exception leaves the library, and the program is never ended; without
 *   memory a function returns G4LIDAR_NO_MEMORY. (Where memory runs out within a running lidar, see
 *   docs/contracts.md.)
 */
#ifndef G4LIDAR_C_BASE_H
#define G4LIDAR_C_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** The major version of these headers; a different one is incompatible. */
#define G4LIDAR_VERSION_MAJOR 0
/** The minor version: it grows when something is added. */
#define G4LIDAR_VERSION_MINOR 1
/** The patch version: it grows when something is repaired. */
#define G4LIDAR_VERSION_PATCH 0

/** Before each exported function. */
#define G4LIDAR_C_API __attribute__((visibility("default")))

/** Of the structures in arrays that the library also uses as its own types: a compiler assumes that
 *  both may be in the same memory. */
#define G4LIDAR_C_SHARED __attribute__((may_alias))

#ifdef __cplusplus
extern "C" {
#endif

/** How a call ended. Positive values are the problems of docs/errors.md. */
enum g4lidar_result {
  G4LIDAR_OK = 0,            /**< Success. */
  G4LIDAR_BAD_ARGUMENT = -1, /**< A mistake of the caller: NULL, a wrong size, an unknown number. */
  G4LIDAR_NO_MEMORY = -2,    /**< No memory is left. */
  G4LIDAR_NOTHING = -3,      /**< No error: there is nothing to return now. */
  G4LIDAR_INTERNAL = -4,     /**< An error of the library: please report it. */
  G4LIDAR_BAD_OPTION = 1,    /**< A value that is invalid for an option. */
  G4LIDAR_NO_PORT = 2,       /**< No serial port, or none to which a lidar may be attached. */
  G4LIDAR_SEVERAL_PORTS = 3, /**< More than one lidar, and the caller did not name one. */
  G4LIDAR_PERMISSION = 4,    /**< This user may not open it. */
  G4LIDAR_BUSY = 5,          /**< Another program has it open, exclusively. */
  G4LIDAR_NOT_SERIAL = 6,    /**< The path is no serial port. */
  G4LIDAR_BAD_BAUD_RATE = 7, /**< The port cannot do the baud rate. */
  G4LIDAR_CANNOT_CONNECT = 8, /**< The remote end of a network connection does not answer. */
  G4LIDAR_SILENCE = 9,        /**< Not a single byte arrived. */
  G4LIDAR_GARBAGE = 10,       /**< Bytes arrived, none of them valid. */
  G4LIDAR_OTHER_DEVICE = 11,  /**< A device answers that is another model. */
  G4LIDAR_DOES_NOT_STOP = 12, /**< The device scans and does not react to a stop command. */
  G4LIDAR_UNHEALTHY = 13,     /**< The device reports an error of its own. */
  G4LIDAR_TIMEOUT = 14,       /**< What was awaited did not arrive in time; a retry may help. */
  G4LIDAR_WRONG_ANSWER = 15,  /**< Replies arrived, none of them valid for the command. */
  G4LIDAR_NOT_REACHED = 16,   /**< The device did not reach the wanted setting. */
  G4LIDAR_BAD_SETTING = 17,   /**< Refused: the model cannot be set to this value. */
  G4LIDAR_SCANNING = 18,      /**< Refused: the command would disturb the running scan. */
  G4LIDAR_NOT_SCANNING = 19,  /**< Points were requested, but no scan has been started. */
  G4LIDAR_RECONNECTING = 20,  /**< The lidar was lost, and the driver is looking for it. */
  G4LIDAR_GONE = 21,          /**< Unplugged, or closed. */
  G4LIDAR_STALLED = 22,       /**< The stream has stopped although the port is there. */
  G4LIDAR_BROWN_OUT = 23,     /**< The bytes stopped when the motor started: too little power. */
  G4LIDAR_INTERFERENCE = 24,  /**< Another program reads from or writes to the port. */
  G4LIDAR_READ_ONLY = 25,     /**< A file was queried or configured like a device. */
  G4LIDAR_BAD_FILE = 26,      /**< A file without usable content. */
  G4LIDAR_END_OF_INPUT = 27,  /**< A file or connection has ended. */
  G4LIDAR_CANCELLED = 28,     /**< Woken by g4lidar_wake(). */
  G4LIDAR_SYSTEM = 29,        /**< The system refused for another reason: `system_errno`. */
  G4LIDAR_NOT_SUPPORTED = 30  /**< Refused: this model of lidar has no such command. */
};

/** What was being done when something went wrong. */
enum g4lidar_task {
  G4LIDAR_NO_TASK = 0,     /**< There is no error, or it is a mistake of the caller. */
  G4LIDAR_FINDING = 1,     /**< Looking for a port or a device. */
  G4LIDAR_OPENING = 2,     /**< Opening a port, a connection or a file. */
  G4LIDAR_CONFIGURING = 3, /**< Setting options, of the port or of the device. */
  G4LIDAR_ASKING = 4,      /**< Waiting for the reply to a command. */
  G4LIDAR_STARTING = 5,    /**< Starting the scan. */
  G4LIDAR_READING = 6,     /**< Reading the stream. */
  G4LIDAR_WRITING = 7,     /**< Sending a command, or writing a file. */
  G4LIDAR_STOPPING = 8     /**< Stopping the scan. */
};

/** An error in the memory of the caller. On success `code` and the texts are empty. */
typedef struct g4lidar_error {
  int32_t code;         /**< A g4lidar_result. */
  int32_t task;         /**< A g4lidar_task. */
  int32_t system_errno; /**< The error number of the system, or 0. */
  int32_t is_fatal; /**< 1: further calls with this handle cannot succeed, so a loop should end. */
  char subject[96]; /**< What the error is about: a path, an option and its value; may be empty. */
  char message
      [256]; /**< A sentence: "opening /dev/ttyUSB0: this user may not open it (EACCES, ...)." */
  char advice[256]; /**< What to try: sentences. */
} g4lidar_error;

/** "permission", "no_port": the name of a g4lidar_result in tools and documents. Valid forever; never
 *  NULL. Any thread. */
G4LIDAR_C_API const char* g4lidar_result_name(int result);

/** The version of the library, "0.1.0". Valid forever. Any thread. */
G4LIDAR_C_API const char* g4lidar_version(void);
/** The same as a number: 10000 * major + 100 * minor + patch. Any thread. */
G4LIDAR_C_API int g4lidar_version_number(void);
/** Whether the library was built with a feature: "zstd" (compressed recordings), "simulator". False
 *  for an unknown name and for NULL. Any thread. */
G4LIDAR_C_API bool g4lidar_has_feature(const char* feature);

/** The current time of the clock that all times of lidars use, except those of recordings and of
 *  virtual time: CLOCK_MONOTONIC, in nanoseconds. Any thread. */
G4LIDAR_C_API int64_t g4lidar_now_ns(void);

/** A lidar, opened; see lidar.h. */
typedef struct g4lidar_lidar g4lidar_lidar;
/** A recording that is being written; see recording.h. */
typedef struct g4lidar_recorder g4lidar_recorder;
/** A recording that is being read; see recording.h. */
typedef struct g4lidar_reader g4lidar_reader;
/** A simulated lidar; see simulator.h. */
typedef struct g4lidar_simulator g4lidar_simulator;

#ifdef __cplusplus
}
#endif

#endif
