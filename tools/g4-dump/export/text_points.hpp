// SPDX-License-Identifier: MIT
// Points from text in the format of the writers: csv and jsonl, one line per point.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/point.hpp"
#include "io/text_sink.hpp"
#include "point_writer.hpp"

namespace g4_tool {

/// The format of the text.
enum class text_source : std::uint8_t { csv, jsonl };

/// The point of a line.
struct read_point {
  g4lidar::point point;
  /// Whether its revolution is incomplete, if the line has that value.
  std::optional<bool> partial{};
};

/// Parses lines. Columns and keys are found by their names (angle_deg, and range_mm or range_m;
/// optionally scan, time_ns, intensity from 0 to 65535 and sample_flags from 0 to 3), in any order,
/// among any others. *Single thread.*
class point_lines {
 public:
  /// `in`: the frame of the angles in the text. `model`: the model of the lidar, for the turn of that
  /// frame and the shortest range; it outlives this.
  point_lines(text_source form, frame in, const g4lidar::model& model = g4_model) noexcept
      : form_(form), frame_(in), model_(&model) {}

  /// The point of a line without its line end; nothing if it contains none, like the header line of
  /// csv.
  [[nodiscard]] std::optional<read_point> read(std::string_view line);
  /// Whether the header line of csv lacks the columns that points need.
  [[nodiscard]] bool is_foreign() const noexcept { return is_foreign_; }
  /// Whether the header line of csv, or a line of jsonl so far, has `intensity`.
  [[nodiscard]] bool has_intensity() const noexcept { return has_intensity_; }
  /// The same for `sample_flags`.
  [[nodiscard]] bool has_sample_flags() const noexcept { return has_sample_flags_; }
  /// "intensity" or "sample_flags" if the lines have it although the model does not; else empty. The
  /// points contain it. Valid forever.
  [[nodiscard]] std::string_view unexpected() const noexcept;
  /// The column or key of the last line without a point that has no valid value. Valid forever; empty
  /// before such a line.
  [[nodiscard]] std::string_view bad_column() const noexcept { return bad_column_; }
  /// The model of the lidar.
  [[nodiscard]] const g4lidar::model& model() const noexcept { return *model_; }

 private:
  static constexpr std::size_t no_column = 1000;
  struct columns {
    std::size_t scan = no_column;
    std::size_t angle = no_column;
    std::size_t range = no_column;
    std::size_t time = no_column;
    std::size_t intensity = no_column;
    std::size_t sample_flags = no_column;
  };
  struct fields {
    std::string_view scan{};
    std::string_view angle{};
    std::string_view range{};
    std::string_view time{};
    std::string_view intensity{};
    std::string_view sample_flags{};
  };

  void read_names(std::string_view line);
  [[nodiscard]] fields csv_fields(std::string_view line) const;
  [[nodiscard]] fields json_fields(std::string_view line);
  [[nodiscard]] std::optional<point> point_of(const fields& found);

  text_source form_;
  g4lidar::frame frame_;
  const g4lidar::model* model_;
  columns columns_;
  bool has_names_ = false;
  bool is_foreign_ = false;
  bool has_intensity_ = false;
  bool has_sample_flags_ = false;
  std::string_view bad_column_;
  float mm_ = 1.0F;  // the unit of the range in mm
};

/// Reads text in pieces and passes its points to a point_writer, or its revolutions if the writer
/// accepts these. It takes no more text after a header line of csv without the columns that points need,
/// and from the first line on that has a value which the model does not have, see unexpected(): a writer
/// for that model leaves it out. Constant memory: lines of up to 64 KiB, revolutions of up to 16,384
/// points.
/// *Single thread, allocates on construction.*
class text_points {
 public:
  /// `writer`, `out` and `model`, the model of the lidar, must outlive this.
  text_points(text_source form, frame in, point_writer& writer, text_sink& out,
              const model& model = g4_model);

  /// Adds the next text, in pieces of any size.
  void take(std::string_view text);
  /// The text has ended: writes the rest.
  void finish();

  /// Points read so far.
  [[nodiscard]] std::uint64_t points() const noexcept { return points_; }
  /// Lines without a point, except the header line of csv and empty lines.
  [[nodiscard]] std::uint64_t bad_lines() const noexcept { return bad_lines_; }
  /// A line without a point: its number, the first line of the text being 1, and point_lines::bad_column() of it,
  /// empty if it is too long.
  struct bad_line {
    std::uint64_t number = 0;
    std::string_view column{};
  };
  /// The first one; with the number 0 if there is none. Valid as long as this reader.
  [[nodiscard]] const bad_line& first_bad_line() const noexcept { return first_bad_; }
  /// See point_lines.
  [[nodiscard]] bool is_foreign() const noexcept { return lines_.is_foreign(); }
  /// See point_lines.
  [[nodiscard]] std::string_view unexpected() const noexcept { return lines_.unexpected(); }

 private:
  static constexpr std::size_t longest_line = 65'536;

  void take_line(std::string_view line);
  void count_bad_line(std::string_view column) noexcept;
  void take_point(const read_point& read);
  /// Passes the collected points to the writer; `cut`: although the revolution is not complete.
  void hand_over(bool cut);

  point_lines lines_;
  point_writer& writer_;
  text_sink& out_;
  bool by_scan_;
  std::string rest_;  // of an incomplete line
  bool is_too_long_ = false;
  std::vector<point> gathered_;
  std::optional<bool> partial_;  // the value of the lines
  bool begun_ = false;
  bool is_header_due_ = false;
  bool is_first_scan_ = true;
  bool was_cut_ = false;
  std::uint32_t revolution_ = 0;
  std::uint64_t points_ = 0;
  std::uint64_t lines_read_ = 0;
  std::uint64_t bad_lines_ = 0;
  bad_line first_bad_;
};

}  // namespace g4_tool
