// SPDX-License-Identifier: MIT
// Points out of the text that g4-dump writes: csv and jsonl, a line for each point.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/point.hpp"
#include "output.hpp"
#include "point_writer.hpp"

namespace g4_dump {

enum class text_source : unsigned char { csv, jsonl };

/// A point as a line tells of it.
struct read_point {
  g4lidar::point point;
  std::optional<bool> partial{};  ///< Whether it says that its revolution was not seen whole.
};

/// Reads lines. *Single thread.*
class point_lines {
 public:
  /// `frame`: in which the angles are.
  point_lines(text_source form, g4lidar::frame frame) noexcept : form_(form), frame_(frame) {}

  /// The point in a line without its end; nothing where there is none in it.
  [[nodiscard]] std::optional<read_point> read(std::string_view line);
  /// Whether the first line of a csv has named no columns that tell of points.
  [[nodiscard]] bool is_foreign() const noexcept { return is_foreign_; }

 private:
  static constexpr std::size_t no_column = 1000;
  struct columns {
    std::size_t scan = no_column;
    std::size_t angle = no_column;
    std::size_t range = no_column;
    std::size_t time = no_column;
  };
  struct fields {
    std::string_view scan{};
    std::string_view angle{};
    std::string_view range{};
    std::string_view time{};
  };

  void read_names(std::string_view line);
  [[nodiscard]] fields csv_fields(std::string_view line) const;
  [[nodiscard]] fields json_fields(std::string_view line);
  [[nodiscard]] std::optional<g4lidar::point> point_of(const fields& found) const;

  text_source form_;
  g4lidar::frame frame_;
  columns columns_;
  bool has_names_ = false;
  bool is_foreign_ = false;
  float mm_ = 1.0F;  // that a unit of the range is
};

/// Bytes of text to a writer, in constant memory: points, or revolutions where it takes these.
class text_points {
 public:
  /// `writer` and `out` outlive this.
  text_points(text_source form, g4lidar::frame frame, point_writer& writer, output& out);

  void take(std::string_view text);
  /// No more will come.
  void finish();

  [[nodiscard]] std::uint64_t points() const noexcept { return points_; }
  /// Lines that tell of no point, but for the first one of a csv and empty ones.
  [[nodiscard]] std::uint64_t bad_lines() const noexcept { return bad_lines_; }
  [[nodiscard]] bool is_foreign() const noexcept { return lines_.is_foreign(); }

 private:
  static constexpr std::size_t longest_line = 65'536;
  static constexpr std::size_t largest_scan = 16'384;

  void take_line(std::string_view line);
  void take_point(const read_point& read);
  /// What has been gathered goes to the writer; `cut`: though the revolution goes on.
  void hand_over(bool cut);

  point_lines lines_;
  point_writer& writer_;
  output& out_;
  bool by_scan_;
  std::string rest_;  // of a line
  bool is_too_long_ = false;
  std::vector<g4lidar::point> gathered_;
  std::optional<bool> partial_;  // what the lines say
  bool begun_ = false;
  bool is_header_due_ = false;
  bool is_first_scan_ = true;
  bool was_cut_ = false;
  std::uint32_t revolution_ = 0;
  std::uint64_t points_ = 0;
  std::uint64_t bad_lines_ = 0;
};

}  // namespace g4_dump
