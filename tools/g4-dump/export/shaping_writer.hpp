// SPDX-License-Identifier: MIT
// A writer before another writer: shapes points, converts their times, and stops at a limit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "g4lidar/filter/too_near.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/scan_shaper.hpp"
#include "io/text_sink.hpp"
#include "point_writer.hpp"
#include "time_shift.hpp"

namespace g4_tool {

/// What a shaping_writer does. By default it changes nothing.
struct writing_options {
  /// How a scan_shaper shapes revolutions. A stream of points is marked and filtered in the same way; its last points
  /// wait for their neighbours: see finish().
  shaping_options shape{};
  /// The model of the lidar, for a stream of points; revolutions have that of their scan. Not null.
  const g4lidar::model* model = &g4_model;
  /// The sample rate of the lidar, in the same way, for mark_limits::near. 0: the usual one of the model.
  std::uint32_t sample_rate_hz = 0;
  /// The poses of the robot by its odometry, times ascending, of the same clock as those of the points. Also
  /// for scan_record::robot. A view of the caller's memory, which outlives the writer.
  std::span<const stamped_pose> path{};
  bool on_path_only = false;  ///< Revolutions at whose first point `path` has no pose are left out.
  bool for_grid = false;      ///< Writes scan_shaper::for_grid(), for make_grid_writer().
  time_style time = time_style::monotonic;  ///< What is written in the place of times.
  std::int64_t wall_ahead_ns = 0;   ///< For time_style::absolute: wall clock minus monotonic clock.
  bool follows_wall_clock = false;  ///< Measures that again while it runs: for live data.
  bool partial_scans = true;        ///< Whether pieces of revolutions are written.
  /// Points before this time since the first point are left out, and revolutions with such points.
  std::int64_t from_ns = 0;
  /// The same for points at this time and later. The first such point ends the output.
  std::int64_t to_ns = std::numeric_limits<std::int64_t>::max();
  std::uint64_t count = std::numeric_limits<std::uint64_t>::max();  ///< The most records.
};

/// Passes points or revolutions on to another writer, as `writing_options` specify. *Single thread,
/// allocates.* Exceptions of the sink pass through.
class shaping_writer final : public point_writer {
 public:
  /// `inner` is not null.
  shaping_writer(std::unique_ptr<point_writer> inner, const writing_options& options);

  /// As the other writer. One that deskews takes revolutions, and passes their points on.
  [[nodiscard]] bool takes_scans() const noexcept override {
    return options_.shape.deskew != deskewing::none || inner_->takes_scans();
  }
  /// As point_writer::begin(); the first record calls it if nobody has.
  void begin(text_sink& out) override;
  /// Writes any number of points.
  void write_points(std::span<const point> points, text_sink& out) override;
  /// Writes a revolution, or a piece of one.
  void write_scan(const scan_record& record, text_sink& out) override;
  /// Writes the points that waited for their neighbours. Nothing is written after it.
  void finish(text_sink& out);

  /// Whether nothing more will be written: the count or the end of the range is reached.
  [[nodiscard]] bool is_done() const noexcept { return done_; }
  /// Whether there was something to write, before filters: in the range of time, and a whole revolution where only these
  /// are written.
  [[nodiscard]] bool has_taken() const noexcept { return has_taken_; }
  /// How many pieces of revolutions were left out.
  [[nodiscard]] std::uint64_t pieces_left_out() const noexcept { return pieces_; }
  /// How many revolutions were left out because the path has no pose for them.
  [[nodiscard]] std::uint64_t scans_off_path() const noexcept { return off_path_; }
  /// How many points were written as they were, because their motion is not known.
  [[nodiscard]] std::uint64_t points_not_deskewed() const noexcept { return not_deskewed_; }

 private:
  /// Those of `points` that are in the range of time.
  [[nodiscard]] std::span<const point> in_range(std::span<const point> points);
  /// The points of the stream that can be marked now, marked; `is_end`: all.
  [[nodiscard]] std::span<const point> marked_stream(std::span<const point> points, bool is_end);
  void write_stream(std::span<const point> points, text_sink& out);
  void pass_on(std::span<const point> points, text_sink& out);
  /// The points with the times that are written.
  [[nodiscard]] std::span<const point> timed(std::span<const point> points);
  void follow_wall_clock();

  std::unique_ptr<point_writer> inner_;
  writing_options options_;
  scan_shaper shaper_;
  near_history near_;  // of the stream, as what follows
  sample_spacing spacing_;
  std::vector<point> stream_;  // marked, with the neighbours of what comes next
  std::size_t passed_on_ = 0;  // of `stream_`
  std::vector<point> shaped_;
  time_shift times_;
  time_shift scan_times_;
  std::optional<std::int64_t> first_ns_;
  bool begun_ = false;
  bool done_ = false;
  bool has_taken_ = false;
  std::uint64_t records_ = 0;
  std::uint64_t pieces_ = 0;
  std::uint64_t off_path_ = 0;
  std::uint64_t not_deskewed_ = 0;
};

}  // namespace g4_tool
