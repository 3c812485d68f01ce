// SPDX-License-Identifier: MIT
// Where points and revolutions of any input go: shaped, with the times that are wanted, to a file or to several.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "cli/common_options.hpp"
#include "export/shaping_writer.hpp"
#include "g4lidar/options/filter_text.hpp"
#include "io/output.hpp"
#include "output_form.hpp"

namespace g4_tool {

/// What dump, scan, decode, replay and convert do with points.
struct point_options {
  shared_options common = std::make_shared<common_options>();
  output_form form;
  bool returns_only = false;  ///< Without the points from which nothing came back.
  bool partial = false;       ///< Whether pieces of revolutions are written, too.
  lidar_options source{};     ///< How it is opened; the range of `playback` holds for text, too.
  bool whole_file = false;    ///< OUT appears at the end, even where the source is a pipe.
  bool json_counts = false;   ///< The counts as JSON, instead of all messages.
};

/// Where the times of points come from.
enum class time_origin : unsigned char {
  live,      ///< The clock of the computer.
  recorded,  ///< That of another time.
  counted,   ///< Samples, from the first point on.
  written,   ///< The text that is read.
};

class point_output {
 public:
  /// Loads the files that the options name. Throws a failure or a bad_value.
  point_output(const point_options& options, time_origin origin);

  /// Opens OUT. `has_end`: what is read has one, so that OUT appears when everything is written.
  void open(bool has_end);
  /// Makes the writer, with the columns and the turn of the model. After open().
  void use_model(const model& model);

  [[nodiscard]] output& out() noexcept {
    return *out_;  // NOLINT(bugprone-unchecked-optional-access): made by open()
  }
  [[nodiscard]] shaping_writer& writer() noexcept { return *writer_; }
  [[nodiscard]] const shaping_writer& writer() const noexcept { return *writer_; }
  /// Writes points.
  void write(std::span<const point> found);
  /// Writes a revolution. Returns whether it was left out as a piece.
  bool write(const scan& found);
  /// Writes what is left, and ends the file.
  void commit();
  /// Logs what was left out.
  void report() const;

 private:
  void choose_files();
  void load_path();
  void choose_times();
  [[nodiscard]] std::span<const point> from_first(std::span<const point> found);

  point_options options_;
  common_options& common_ = *options_.common;
  time_origin origin_;
  numbered_files files_;
  g4lidar::mask mask_;
  std::vector<stamped_pose> path_;
  writing_options how_;                   // but for the model
  std::optional<std::int64_t> first_ns_;  // of counted times
  std::vector<point> moved_;              // to count from there
  std::optional<output> out_;
  std::unique_ptr<shaping_writer> writer_;
  point_file_writer* point_file_ = nullptr;  // behind writer_
};

}  // namespace g4_tool
