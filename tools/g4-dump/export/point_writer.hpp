// SPDX-License-Identifier: MIT
// Points and revolutions as text: csv, JSON lines, and columns for people. Each writer writes only
// to the text_sink of the caller.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "cli/written_form.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/scan.hpp"
#include "io/text_sink.hpp"

namespace g4_tool {

using namespace g4lidar;

/// How points and revolutions are written.
struct text_style {
  text_format format = text_format::csv;
  bool scans = false;        ///< One record per revolution, not per point.
  frame to = frame::vendor;  ///< The frame of the written angles.
  /// model::turn_deg of the lidar, 0 or 180, for points; revolutions have that of their model.
  std::uint16_t turn_deg = g4_model.turn_deg;
  length_unit unit = length_unit::millimetres;
  /// jsonl: points are written as they arrive, without the key `partial`, which is known only at
  /// the end of the revolution.
  bool as_they_come = false;
  bool intensity = false;     ///< csv, jsonl: points have `intensity`.
  bool sample_flags = false;  ///< csv, jsonl: points have `sample_flags`.
  unsigned time_width = 5;    ///< text: the width of the seconds, in digits.
};

/// A revolution and what is written with it.
struct scan_record {
  g4lidar::scan scan;  ///< Contains only the points that are to be written.
  std::int64_t time_ns =
      0;  ///< The time of its first point, including points that are not written.
  double measured_hz = 0.0;  ///< The rotation frequency; 0 if it is not known.
  pose_2d robot{};           ///< Where the robot was at `time_ns`; 0 if it is not known.
};

/// Writes records to a sink: of points or of revolutions, one of the two. *Single thread.* Points
/// have the values that the library produces: `angle_deg` in [0, 360) of the device's frame,
/// `range_mm` in [0, 100,000,000). The writers do not change the numbers of points and leave none
/// out (shaping_writer does).
///
/// csv of points, a header line and one line per point:
///
/// | column | unit and meaning |
/// |---|---|
/// | `scan` | the number of the revolution, point::revolution |
/// | `angle_deg` | degrees in style.to, six decimals: vendor in [0, 360), robot in [-180, 180) |
/// | `range_mm` or `range_m` | two or five decimals; 0: no return, which is not free space |
/// | `time_ns` | point::time_ns |
/// | `intensity`, `sample_flags` | those of the point; each only if the style has it |
///
/// More columns may follow; the columns above do not change their position. jsonl has keys with the
/// same names, and `no_return`, `too_near` and `partial` (true, false); `not_deskewed`, `unlikely`,
/// `isolated`, `veiling` and `may_be_too_near` (true) only where that flag is set.
///
/// csv of revolutions:
///
/// | column | unit and meaning |
/// |---|---|
/// | `scan`, `time_ns` | the number of the revolution; the time of its first point |
/// | `points`, `returns` | how many points are written, and how many of these are returns |
/// | `partial`, `why` | true or false; the flags that are set, joined by `+` |
/// | `turned_deg` | scan::turned_deg, two decimals |
/// | `reported_hz`, `measured_hz` | the rotation frequency; empty where it is not known |
///
/// jsonl has keys with the same names (null if not known), `suspect_samples`, and arrays of the
/// points: `angle_deg`, `range_mm` or `range_m`, `time_ns`, and if the style has them `intensity`,
/// `sample_flags`.
class point_writer {
 public:
  point_writer() = default;
  point_writer(const point_writer&) = delete;
  point_writer& operator=(const point_writer&) = delete;
  virtual ~point_writer();

  /// Whether it writes revolutions: then call write_scan(), and not write_points().
  [[nodiscard]] virtual bool takes_scans() const noexcept = 0;
  /// Writes what precedes the first record: the header line of csv. Call it once.
  virtual void begin(text_sink& out);
  /// Writes any number of points.
  virtual void write_points(std::span<const point> points, text_sink& out);
  /// Writes a revolution, or a piece of one.
  virtual void write_scan(const scan_record& record, text_sink& out);
};

/// The writer for `style`.
[[nodiscard]] std::unique_ptr<point_writer> make_point_writer(const text_style& style);

/// The writer of revolutions as `bins` ranges at equal steps of 360 / `bins` degrees, the first one
/// at 0 degrees, in the robot's frame at -180. Columns of csv: `scan`, `time_ns`, `partial`, and
/// `range_mm_0` or `range_m_0` and so on: `inf` if nothing came back, `nan` if nothing is known, `-inf`
/// if a target may be too near, as `options` sets (grid.hpp; its frame is that of `style`). jsonl:
/// `angle_min_deg`, `angle_step_deg`, and `ranges_mm` or `ranges_m`, with "inf", null and "-inf" for
/// these. *Allocates on construction.*
[[nodiscard]] std::unique_ptr<point_writer> make_grid_writer(const text_style& style,
                                                             std::size_t bins,
                                                             const grid_options& options = {});

}  // namespace g4_tool
