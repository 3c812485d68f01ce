/* SPDX-License-Identifier: MIT */
/**
 * @file
 * Points, scans and frames of reference; coordinates and grids of points. The functions are pure: any
 * thread may call them at any time; they never allocate. The layouts of g4lidar_point, g4lidar_xy and
 * g4lidar_polar do not change.
 */
#ifndef G4LIDAR_C_POINT_H
#define G4LIDAR_C_POINT_H

#include "g4lidar/c/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Properties of a point; a set of bits. */
enum g4lidar_point_flag {
  G4LIDAR_NO_RETURN =
      1, /**< Nothing came back: `range_mm` is 0 and not a range, and the way not free. */
  G4LIDAR_TOO_NEAR = 2, /**< Below the model's shortest range, 100 mm for a G4: not reliable. */
  G4LIDAR_REVOLUTION_START = 4, /**< The first sample of its revolution. */
  G4LIDAR_NOT_DESKEWED = 8,     /**< Deskewing left it where it was. */
  G4LIDAR_UNLIKELY = 16,        /**< Its packet or its neighbours contradict it. */
  G4LIDAR_ISOLATED = 32,        /**< No other return is near; set by g4lidar_shaper. */
  G4LIDAR_VEILING = 64,         /**< Between two surfaces; set by g4lidar_shaper. */
  G4LIDAR_MAY_BE_TOO_NEAR = 128 /**< Without return, perhaps of something too near; set by
                                     g4lidar_shaper. */
};

/** One measured point in the device's own frame, 24 bytes. */
typedef struct G4LIDAR_C_SHARED g4lidar_point {
  /** Clockwise degrees in [0, 360) seen from above, 0 at the cable exit. */
  float angle_deg;
  float range_mm;  /**< The distance in millimetres, 0 for no return, which is not free space. */
  int64_t time_ns; /**< When it was measured, by the monotonic clock; 0 where it is not known. */
  uint32_t revolution;  /**< Which revolution since the start of the stream, from 0. */
  uint8_t flags;        /**< g4lidar_point_flag. */
  uint8_t sample_flags; /**< The flags that the sample contains, 0 to 3; 0 if the model has none. */
  uint16_t intensity;   /**< In a unit of the device; 0 if the model does not measure it. */
} g4lidar_point;

/** A point in Cartesian coordinates, 16 bytes; both coordinates are NaN for a point without return. */
typedef struct G4LIDAR_C_SHARED g4lidar_xy {
  float x_m;       /**< Metres. */
  float y_m;       /**< Metres. */
  int64_t time_ns; /**< As in the point. */
} g4lidar_xy;

/** A direction and a range in SI units. */
typedef struct G4LIDAR_C_SHARED g4lidar_polar {
  float bearing_rad; /**< In [-pi, pi). */
  float range_m;     /**< 0 for no return. */
} g4lidar_polar;

/** The frames of reference. (protocol: Frames of reference) */
enum g4lidar_frame {
  G4LIDAR_VENDOR = 0, /**< The device's own: clockwise, 0 at the cable exit. */
  /** REP 103: counter-clockwise, x forward (of a G4 opposite the cable), y to the left. A direction
   *  there is the turn of the model, 0 or 180, minus that in the device's frame. */
  G4LIDAR_ROBOT = 1
};

/** Why a scan is not one whole revolution; a set of bits. */
enum g4lidar_scan_flag {
  G4LIDAR_START_MISSING = 1,   /**< Begins within a revolution. */
  G4LIDAR_END_MISSING = 2,     /**< Ends within a revolution. */
  G4LIDAR_DATA_LOST = 4,       /**< Bytes were lost between its points. */
  G4LIDAR_TURN_SHORT = 8,      /**< Its end came well before a full turn. */
  G4LIDAR_START_BY_ANGLE = 16, /**< The packet that begins it was lost: cut by the angle. */
  G4LIDAR_END_BY_ANGLE = 32,   /**< The packet that ends it was lost: cut by the angle. */
  G4LIDAR_CRC_MISMATCH = 64    /**< A packet was lost, by the CRC byte of devices that send one. */
};

/** One revolution. A view; the function that returns it defines its lifetime. */
typedef struct g4lidar_scan {
  const g4lidar_point* points;   /**< In the order in which they were measured. */
  size_t point_count;            /**< Their number. */
  int64_t time_ns;               /**< When its first point was measured; 0 if not known. */
  int64_t end_ns;                /**< When the next scan began, or the last point was measured. */
  int64_t duration_ns;           /**< The time for its turn; 0 if not known. */
  uint32_t revolution;           /**< The number of revolutions before it. */
  uint32_t flags;                /**< g4lidar_scan_flag; 0 for a whole revolution. */
  uint32_t suspect_packets;      /**< Left out, because their angles contradict each other. */
  uint32_t suspect_samples;      /**< The samples of these packets. */
  uint32_t sample_rate_hz;       /**< The configured sample rate. */
  float measured_sample_rate_hz; /**< By the times of its points. */
  float frequency_hz;            /**< The measured rotation frequency; 0 if not known. */
  float reported_frequency_hz;   /**< As the device reports it; 0 if it does not. */
  float turned_deg;              /**< The turn from its first point to the next scan: about 360. */
  bool is_whole;                 /**< One revolution without known loss. */
  bool is_piece;                 /**< Only a part of a turn. */
  uint16_t turn_deg;             /**< The turn of its model for G4LIDAR_ROBOT, 0 or 180. */
  float longest_range_mm;        /**< The longest range of its model by the manufacturer. */
  uint32_t default_bins;         /**< Bins of a grid of which few are empty: 720 for a G4. */
  const char* model;             /**< The word of its model, "g4". Valid forever. */
} g4lidar_scan;

/** Writes `count` points as x and y in `frame`, a g4lidar_frame, to `out`, which is as long. `turn_deg`:
 *  g4lidar_scan::turn_deg, 180 for a G4. */
G4LIDAR_C_API int g4lidar_to_xy(const g4lidar_point* points, size_t count, int frame,
                                unsigned turn_deg, g4lidar_xy* out);

/** Writes `count` points as directions and ranges in `frame` to `out`, which is as long. */
G4LIDAR_C_API int g4lidar_to_polar(const g4lidar_point* points, size_t count, int frame,
                                   unsigned turn_deg, g4lidar_polar* out);

/** Which point determines the range of a bin of a grid. */
enum g4lidar_grid_pick {
  G4LIDAR_NEAREST = 0, /**< The point whose direction is nearest to the middle of the bin. */
  G4LIDAR_MINIMUM = 1  /**< The point with the smallest range. */
};

/** What a direction without return becomes in a grid. That nothing came back does not mean that the way is
 *  free: what is nearer than the shortest range (0.28 m at 9 kHz) may give no return either. */
enum g4lidar_no_return_as {
  G4LIDAR_NO_RETURN_AS_INFINITY = 0, /**< +infinity (REP 117). */
  G4LIDAR_NO_RETURN_AS_NAN = 1,      /**< NaN. */
  G4LIDAR_NO_RETURN_AS_MAX = 2       /**< g4lidar_grid_options::longest_range_mm. */
};

/** How to fill a grid. */
typedef struct g4lidar_grid_options {
  size_t struct_size; /**< Set by g4lidar_grid_options_init(). */
  /** A g4lidar_frame; G4LIDAR_ROBOT by default, where bin 0 is centred at -180 degrees; 0 in the other. */
  int32_t frame;
  int32_t pick;        /**< A g4lidar_grid_pick. */
  bool keep_too_near;  /**< Whether points flagged G4LIDAR_TOO_NEAR give their range; else NaN. */
  uint8_t reserved[7]; /**< 0. */
  int32_t no_return;   /**< A g4lidar_no_return_as; G4LIDAR_NO_RETURN_AS_INFINITY. */
  int32_t
      near_is_minus_infinity; /**< 1: what is flagged G4LIDAR_MAY_BE_TOO_NEAR is -infinity; 0: NaN. */
  uint32_t turn_deg;          /**< g4lidar_scan::turn_deg; 180, that of a G4. */
  float longest_range_mm;     /**< g4lidar_scan::longest_range_mm; 16000, that of a G4. */
} g4lidar_grid_options;

/** Sets the defaults, those of a ROS LaserScan; `size` is sizeof(g4lidar_grid_options). */
G4LIDAR_C_API void g4lidar_grid_options_init(g4lidar_grid_options* options, size_t size);

/** Sets `turn_deg` and `longest_range_mm` to those of a model: g4lidar_scan::model; NULL: a G4. */
G4LIDAR_C_API int g4lidar_grid_options_set_model(g4lidar_grid_options* options, const char* model);

/** Fills `bins` ranges, at least 1, in metres: +infinity, or what the options set, where the lidar measured
 *  and nothing came back, which is not free space; NaN where nothing is known. At most 16,777,216 points. `options` NULL: the
 *  defaults, which are those of a G4. */
G4LIDAR_C_API int g4lidar_fill_grid(const g4lidar_point* points, size_t count,
                                    const g4lidar_grid_options* options, float* ranges_m,
                                    size_t bins);

#ifdef __cplusplus
}
#endif

#endif
