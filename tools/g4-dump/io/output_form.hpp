// SPDX-License-Identifier: MIT
// The forms in which points and revolutions are written, and the writer of each.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "cli/common_options.hpp"
#include "export/pcd.hpp"
#include "export/point_file.hpp"
#include "io/output.hpp"

namespace g4_tool {

/// The formats of which a file holds one revolution.
enum class scan_file : unsigned char { none, pcd, svg };

/// The formats for SLAM programs, with a line for each revolution.
enum class slam_log : unsigned char { none, carmen, tum };

/// One of them; by default text.
struct output_form {
  text_style style{.format = text_format::text, .as_they_come = true};
  std::size_t bins = 0;              ///< 0: points and no grid.
  scan_file file = scan_file::none;  ///< One file for each revolution.
  pcd_data data = pcd_data::binary;
  std::optional<point_file_format> point_file;  ///< One file for all points.
  slam_log log = slam_log::none;                ///< carmen: of `bins` ranges.

  [[nodiscard]] bool has_scan_files() const noexcept { return file != scan_file::none; }
  /// The ranges of a revolution, of which a G4 measures 1286 at 7 Hz; 0: points and no grid.
  [[nodiscard]] std::size_t bins_of(const model& model) const {
    return log == slam_log::carmen && bins == 0 ? std::size_t{2} * default_bins(model) : bins;
  }
};

/// A writer of points, and the same one if its first bytes are known at the end; else null.
struct chosen_writer {
  std::unique_ptr<point_writer> writer;
  point_file_writer* point_file = nullptr;
};

/// Of points of a lidar like `model`, in frame and unit of `common`. `files`: of has_scan_files(), if there are several.
[[nodiscard]] chosen_writer make_writer(const output_form& form, const common_options& common,
                                        const model& model, const numbered_files& files);

}  // namespace g4_tool
