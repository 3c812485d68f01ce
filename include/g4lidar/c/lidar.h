/* SPDX-License-Identifier: MIT */
/**
 * @file
 * A lidar: opened, queried, started, read, and reconnected after an unplug.
 */
#ifndef G4LIDAR_C_LIDAR_H
#define G4LIDAR_C_LIDAR_H

#include "g4lidar/c/point.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The settings of a lidar, with the unit of their values. */
enum g4lidar_setting {
  G4LIDAR_SAMPLE_RATE =
      1, /**< Measurements: Hz, a rate of the model; of a G4 4000, 8000 or 9000. */
  G4LIDAR_SCAN_FREQUENCY =
      2, /**< Revolutions: 0.01 Hz, within the limits of the model; of a G4 500 to 1200. */
  G4LIDAR_MOTOR_DIRECTION = 3,    /**< A g4lidar_direction. */
  G4LIDAR_CONSTANT_FREQUENCY = 4, /**< Whether it regulates its frequency: a g4lidar_switch. */
  G4LIDAR_LOW_POWER = 5,          /**< Whether the motor stops when idle: a g4lidar_switch. */
  /** Whether it stops when the host sends nothing for 3 s: a g4lidar_switch. */
  G4LIDAR_POWER_DOWN_PROTECTION = 6
};

/** In which direction the head turns, seen from above. */
enum g4lidar_direction {
  G4LIDAR_CLOCKWISE = 1,        /**< The default of a G4. */
  G4LIDAR_COUNTER_CLOCKWISE = 2 /**< The other direction. */
};

/** The values of settings with two states. */
enum g4lidar_switch {
  G4LIDAR_OFF = 1, /**< Off. */
  G4LIDAR_ON = 2   /**< On. */
};

/** Whether a request may stop a running scan. */
enum g4lidar_while_scanning {
  G4LIDAR_REFUSE = 0,         /**< It fails with G4LIDAR_SCANNING. */
  G4LIDAR_STOP_AND_RESUME = 1 /**< The scan is stopped and started again. */
};

/** When a running scan is read, and the program woken. */
enum g4lidar_pace {
  G4LIDAR_AUTOMATIC = 0,  /**< By revolutions, until g4lidar_next_points() is called. */
  G4LIDAR_PACKETS = 1,    /**< Each packet: points arrive with little latency. */
  G4LIDAR_REVOLUTIONS = 2 /**< Each revolution: a fifth of the system calls. */
};

/** How a lidar is opened and used. A setting that is 0 stays as the device has it; another one is
 *  set at each start and after a reconnect. A time that is 0 has its default. What the source cannot use is refused with
 *  bad_option: settings, `baud`, `pace`, `reconnect` and the times of a connection for a file. */
typedef struct g4lidar_options {
  size_t struct_size; /**< Set by g4lidar_options_init(). */
  /** Which lidar: "" or NULL for the only lidar; a path; `serial:2021101000070073`; `usb:1-1.4`;
   *  `tcp:host:port`; a recording, or the raw bytes of a port, as a path or `file:PATH`; `-`, raw bytes
   *  from standard input; `sim:` or `sim:?NAME=VALUE&...`, a simulated lidar in real time (docs/sim.md).
   *  Copied. */
  const char* device;
  g4lidar_recorder* recorder; /**< Records everything; see recording.h. NULL: nothing. */
  int64_t transport_delay_ns; /**< The least delay between measurement and arrival, up to 1 s. */
  uint32_t baud;              /**< Bits per second; 0: the usual rate of the model. */
  int32_t frequency_chz;      /**< As G4LIDAR_SCAN_FREQUENCY; 0. */
  int32_t sample_rate_hz;     /**< As G4LIDAR_SAMPLE_RATE; 0. */
  int32_t direction;          /**< A g4lidar_direction; 0. */
  int32_t low_power;          /**< A g4lidar_switch; 0. */
  int32_t constant_frequency; /**< A g4lidar_switch; 0. */
  int32_t protection;         /**< A g4lidar_switch; 0. */
  int32_t pace;               /**< A g4lidar_pace. */
  int32_t longest_backoff_ms; /**< Between two attempts to reconnect, 1 to 1000; 1000. */
  int32_t answer_time_ms;     /**< The longest wait for an answer, 10 to 10000; 300. */
  int32_t stall_time_ms;      /**< A scan without a packet, 100 to 60000; 1000. */
  int32_t batch_ms;           /**< Bytes are read no more often than this, 0 to 100; 0. */
  bool reconnect;             /**< Whether to reconnect after a loss. */
  bool partial_scans;         /**< Whether g4lidar_try_scan() also gives pieces. */
  uint8_t reserved[6];        /**< 0. */
  /** How long to wait for a device that is not there yet; -1: without limit; 0. */
  int32_t device_wait_ms;
  /** The model of the lidar: "x4"; NULL: what a recording or `sim:` states, raw bytes show, or a search at the
   *  port finds.
   *  Copied. */
  const char* model;
  /** Called often while a file is read, and every 50 ms between two attempts to open a device that is waited
   *  for; returning true ends the function that opens with G4LIDAR_CANCELLED. An attempt is not interrupted.
   *  Playing a file calls it, too, in the thread that reads. NULL: never. It must not use the lidar, nor throw
   *  C++ exceptions. */
  bool (*is_cancelled)(void* context);
  void* context; /**< Passed to it; it outlives the lidar. */
  /** What is added to each angle, in 0.01 degrees, -36000 to 36000, if `has_zero_angle`: instead of the answer to
   *  command 93, which raw bytes may not have. Only of a model with this command. */
  int32_t zero_angle_cdeg;
  bool has_zero_angle;      /**< Whether zero_angle_cdeg is given. */
  uint8_t more_reserved[3]; /**< 0. */
  /** Where `device` is no name: whether ports without the USB bridge of a G4 are looked at, too, as with
   *  g4lidar_find_options.probe_all_ports. */
  bool probe_all_ports;
  /** Not a byte is sent: settings and requests are refused. */
  bool listen_only;
  /** `model` is right, whatever number the lidar reports, or model a recording states. */
  bool insist_on_model;
  /** The line DTR of the port is not set: a motor that it drives keeps its state. */
  bool leave_dtr;
  uint8_t last_reserved[4]; /**< 0. */
} g4lidar_options;

/** Sets the defaults; `size` is sizeof(g4lidar_options). */
G4LIDAR_C_API void g4lidar_options_init(g4lidar_options* options, size_t size);

/** Opens the lidar that `device` names, as in g4lidar_options, and queries its identity. A scan that
 *  is running is stopped first. Takes about 60 ms with a healthy lidar, at most 3 s with one fault,
 *  and at most 15 s if many bytes are damaged; 4 s more for each port that is queried first, and 5 s
 *  where a model that was named is silent at its baud rate and is searched at the others. */
G4LIDAR_C_API int g4lidar_open(const char* device, g4lidar_lidar** lidar, g4lidar_error* error);
/** The same with options, which may be NULL. */
G4LIDAR_C_API int g4lidar_open_with(const g4lidar_options* options, g4lidar_lidar** lidar,
                                    g4lidar_error* error);
/** Closes and releases a lidar: stops the motor, unless g4lidar_release() was called, and blocks as
 *  long as g4lidar_close(). */
G4LIDAR_C_API void g4lidar_free(g4lidar_lidar* lidar);

/** Applies the settings of the options and starts the scan. Returns when the device has confirmed:
 *  after about 20 ms, and after at most 10 s with one fault. */
G4LIDAR_C_API int g4lidar_start(g4lidar_lidar* lidar, g4lidar_error* error);
/** Stops the scan: takes about 50 ms, and at most 1.5 s if the device does not react. */
G4LIDAR_C_API int g4lidar_stop(g4lidar_lidar* lidar, g4lidar_error* error);
/** Stops the scan and closes the connection. Every later call fails with G4LIDAR_GONE. */
G4LIDAR_C_API int g4lidar_close(g4lidar_lidar* lidar, g4lidar_error* error);
/** Closes the connection and leaves the device as it is: a running scan continues, unread. */
G4LIDAR_C_API void g4lidar_release(g4lidar_lidar* lidar);

/** The next revolution, if it is complete within `timeout_ms`; below 0 counts as 0. G4LIDAR_TIMEOUT,
 *  G4LIDAR_RECONNECTING and G4LIDAR_CANCELLED are not fatal: call again, or see g4lidar_wait_scan().
 *  The texts of the error state whether the motor spins up, or a lost lidar is looked for. */
G4LIDAR_C_API int g4lidar_try_scan(g4lidar_lidar* lidar, int timeout_ms, const g4lidar_scan** scan,
                                   g4lidar_error* error);
/** The next revolution, for a loop: it waits longer than `timeout_ms` while no scan is due. While the motor spins
 *  up after a start, a restart or a reconnect, it waits until the first scan, at most 10 s or
 *  `timeout_ms`, if that is longer. With reconnecting on it waits without limit while the lidar is
 *  lost. So a loop ends at the end of a file (G4LIDAR_END_OF_INPUT), at a fatal error, when it is
 *  woken (G4LIDAR_CANCELLED), and when a scan that is due does not come in time (G4LIDAR_TIMEOUT). */
G4LIDAR_C_API int g4lidar_wait_scan(g4lidar_lidar* lidar, int timeout_ms, const g4lidar_scan** scan,
                                    g4lidar_error* error);
/** All points since the last call, at least one, and their number in `count`. The first call begins
 *  with the current revolution. Waits and fails like g4lidar_try_scan(). */
G4LIDAR_C_API int g4lidar_next_points(g4lidar_lidar* lidar, int timeout_ms,
                                      const g4lidar_point** points, size_t* count,
                                      g4lidar_error* error);

/** For an event loop: poll this descriptor for reading until g4lidar_deadline_ns(), then call
 *  g4lidar_try_scan() with a timeout of 0 until it returns G4LIDAR_TIMEOUT. It does not change at a
 *  reconnect. -1 if there is none: in virtual time. */
G4LIDAR_C_API int g4lidar_descriptor(const g4lidar_lidar* lidar);
/** The latest time for the next call, by g4lidar_now_ns(); INT64_MAX if only bytes are awaited. */
G4LIDAR_C_API int64_t g4lidar_deadline_ns(const g4lidar_lidar* lidar);
/** The same as the timeout of poll(): milliseconds from now, rounded up; -1 if only bytes are
 *  awaited. */
G4LIDAR_C_API int g4lidar_poll_timeout_ms(const g4lidar_lidar* lidar);
/** Processes what has arrived and never waits, for programs that take no scans now; finished scans
 *  that are not taken count as missed. */
G4LIDAR_C_API int g4lidar_process(g4lidar_lidar* lidar, g4lidar_error* error);
/** Makes a waiting call, or the next one, return early with G4LIDAR_CANCELLED, once; the next call
 *  continues. Any thread, and a signal handler, as long as the lidar is not released, and not during
 *  g4lidar_seek(). */
G4LIDAR_C_API void g4lidar_wake(g4lidar_lidar* lidar);

/** Queries a g4lidar_setting. Of G4LIDAR_CONSTANT_FREQUENCY and G4LIDAR_POWER_DOWN_PROTECTION the
 *  protocol has no query: G4LIDAR_BAD_ARGUMENT. `if_scanning` is a g4lidar_while_scanning, here and below.
 *  Each request blocks at most 15 s, 20 s if a scan is resumed. */
G4LIDAR_C_API int g4lidar_get(g4lidar_lidar* lidar, int setting, int if_scanning, int32_t* value,
                              g4lidar_error* error);
/** Sets a g4lidar_setting, and returns the value that the device reports afterwards in `reached`, which
 *  may be NULL. It is set again at each start and after a reconnect. */
G4LIDAR_C_API int g4lidar_set(g4lidar_lidar* lidar, int setting, int32_t wanted, int if_scanning,
                              int32_t* reached, g4lidar_error* error);
/** Changes the scan frequency by `step_chz` 0.01 Hz: -100, -10, 10 or 100. The frequency afterwards, in
 *  0.01 Hz, is in `reached`, which may be NULL; at the end of the range it is the same as before. */
G4LIDAR_C_API int g4lidar_step_frequency(g4lidar_lidar* lidar, int32_t step_chz, int if_scanning,
                                         int32_t* reached, g4lidar_error* error);
/** Restarts the device, and waits until it replies again. */
G4LIDAR_C_API int g4lidar_restart(g4lidar_lidar* lidar, int if_scanning, g4lidar_error* error);

/** The status that the device reports. */
enum g4lidar_health_status {
  G4LIDAR_HEALTHY = 0,        /**< No fault. */
  G4LIDAR_HEALTH_WARNING = 1, /**< A fault that does not prevent a scan. */
  G4LIDAR_HEALTH_ERROR = 2    /**< A fault that prevents it. */
};

/** The health that the device reports. */
typedef struct g4lidar_health {
  int32_t status;      /**< A g4lidar_health_status. */
  uint32_t error_code; /**< Its meaning is not known. */
} g4lidar_health;

/** Queries the health. */
G4LIDAR_C_API int g4lidar_get_health(g4lidar_lidar* lidar, int if_scanning, g4lidar_health* health,
                                     g4lidar_error* error);

/** What identifies a lidar. */
typedef struct g4lidar_identity {
  uint8_t model;          /**< 5 is a G4. */
  uint8_t firmware_major; /**< The major version of its firmware. */
  uint8_t firmware_minor; /**< The minor version. */
  uint8_t hardware;       /**< The version of its hardware. */
  char serial_number[20]; /**< 16 digits. */
} g4lidar_identity;

/** What the device reported when it was opened. Valid as long as the lidar. */
G4LIDAR_C_API const g4lidar_identity* g4lidar_get_identity(const g4lidar_lidar* lidar);
/** As which model a lidar is read, from what that is known, and what contradicts it. */
typedef struct g4lidar_recognition {
  const char* model; /**< "x2". Name yours with g4lidar_options.model. */
  /** The models between which its bytes do not decide, `model` first: "x2, x2l, x3". One alone if it was named, or if
   *  the device answers. */
  const char* candidates;
  const char* known_by;       /**< "nothing", "user", "recording", "number" or "samples". */
  const char* contradictions; /**< Sentences for the user; "": nothing contradicts. */
  uint32_t baud;              /**< Of the line; 0: not known. */
  uint8_t number;             /**< Of its model, as the device reports it; 0: it does not. */
  bool is_silent;             /**< It should answer, and only sends. */
  bool was_stopped;           /**< It was scanning when it was opened. */
  uint8_t reserved;           /**< 0. */
} g4lidar_recognition;

/** What is known now; NULL for a NULL lidar, or without memory. Valid until the next call of this function. */
G4LIDAR_C_API const g4lidar_recognition* g4lidar_get_recognition(g4lidar_lidar* lidar);
/** The name of the connection, "/dev/ttyUSB0". */
G4LIDAR_C_API const char* g4lidar_name(g4lidar_lidar* lidar);
/** Whether a scan was started and not stopped; false while the device is lost. */
G4LIDAR_C_API bool g4lidar_is_scanning(const g4lidar_lidar* lidar);

/** Something that happened without a request of the caller; docs/symptoms.md has what to do. */
enum g4lidar_event_kind {
  G4LIDAR_EVENT_LOST = 1,                /**< The connection was lost; `reason` has the cause. */
  G4LIDAR_EVENT_RECONNECTED = 2,         /**< The same device is back. */
  G4LIDAR_EVENT_FOUND_SCANNING = 3,      /**< It was scanning without a start; it was stopped. */
  G4LIDAR_EVENT_PROTECTION_STARVED = 4,  /**< The protection stopped the scan; started again. */
  G4LIDAR_EVENT_PROTECTION_FOUND_ON = 5, /**< The protection was on unexpectedly; started again. */
  G4LIDAR_EVENT_SPINNING_UP = 6,         /**< Started, and no point has come yet. */
  G4LIDAR_EVENT_RESTARTED = 7,           /**< The scan had ended by itself; started again. */
  G4LIDAR_EVENT_HEALTH_WARNING = 8,      /**< The device reports a warning when it is started. */
  G4LIDAR_EVENT_OTHER_LIDAR = 9,         /**< While the lidar was lost, another one answered. */
  G4LIDAR_EVENT_LONG_PAUSE = 10,         /**< The next data of a recording is far away. */
  G4LIDAR_EVENT_OVERFLOW = 11,           /**< Earlier events were dropped. */
  G4LIDAR_EVENT_STILL_TURNING = 12,      /**< The scans have ended, but the motor turns. */
  G4LIDAR_EVENT_NO_ZERO_ANGLE = 13, /**< Points come without the offset of zero of the model. */
  G4LIDAR_EVENT_OTHER_NUMBER = 14   /**< It states a number that its model does not have. */
};

/** An event. */
typedef struct g4lidar_event {
  int32_t kind;    /**< A g4lidar_event_kind. */
  int32_t reason;  /**< Of G4LIDAR_EVENT_LOST: a g4lidar_result; else 0. */
  int64_t time_ns; /**< When, by the clock of the points. */
} g4lidar_event;

/** Takes the oldest event that was not taken yet; G4LIDAR_NOTHING if there is none. Never waits. */
G4LIDAR_C_API int g4lidar_next_event(g4lidar_lidar* lidar, g4lidar_event* event);
/** "lost", "reconnected": the name of a g4lidar_event_kind. Valid forever; never NULL. Any thread. */
G4LIDAR_C_API const char* g4lidar_event_name(int kind);

/** Counts of what some devices of the family send in addition; all are 0 for others. */
typedef struct g4lidar_extra_counts {
  uint64_t time_packets;   /**< Packets with the clock of the device. */
  uint64_t crc_matches;    /**< Revolutions that are complete by the CRC byte of the device. */
  uint64_t crc_mismatches; /**< Revolutions that lost a packet, by that byte. */
  uint64_t empty_packets;  /**< Valid packets without samples, which `packets` does not count. */
} g4lidar_extra_counts;

/** Counts since g4lidar_open(), over all reconnects. bytes = parsed_bytes + the four skipped + held. */
typedef struct g4lidar_counts {
  uint64_t bytes;                /**< From the device. */
  uint64_t held;                 /**< Of an unfinished packet or response. */
  uint64_t parsed_bytes;         /**< Of packets, responses and time packets. */
  uint64_t skipped_noise;        /**< Bytes outside of packets and responses. */
  uint64_t skipped_bad_header;   /**< Bytes of impossible headers. */
  uint64_t skipped_bad_checksum; /**< Bytes of packets with a wrong checksum. */
  uint64_t skipped_truncated;    /**< Bytes of incomplete packets at an end. */
  uint64_t packets;              /**< Valid packets. */
  uint64_t responses;            /**< Valid responses. */
  uint64_t points;               /**< Samples of packets that are not suspect. */
  uint64_t suspect_packets;      /**< Packets whose samples have no known angles. */
  uint64_t samples_lost;         /**< Measured and never received. */
  uint64_t scans;                /**< Revolutions that were completed. */
  uint64_t partial_scans;        /**< Pieces of revolutions. */
  uint64_t scans_missed;         /**< Not taken before the next one was complete. */
  uint64_t points_missed;        /**< Not returned by g4lidar_next_points(), if it is called. */
  uint64_t command_retries;      /**< Commands that had to be sent again. */
  uint64_t reconnects;           /**< How often the device was reconnected. */
  int64_t largest_gap_ns;        /**< Between two packets of one scan. */
  g4lidar_extra_counts extras;   /**< Of what some devices send in addition. */
} g4lidar_counts;

/** All counts as they are now. Valid until the next call of this function; it does not end other
 *  views. */
G4LIDAR_C_API const g4lidar_counts* g4lidar_get_counts(g4lidar_lidar* lidar);

/** Converts a time of a point to the wall clock: nanoseconds since 1970. For a recording, as it was
 *  then; for virtual time, as if it had begun when the lidar was opened. */
G4LIDAR_C_API int64_t g4lidar_wall_ns(const g4lidar_lidar* lidar, int64_t time_ns);

#ifdef __cplusplus
}
#endif

#endif
