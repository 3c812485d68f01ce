// SPDX-License-Identifier: MIT
// The global options, which every verb has, and the options that verbs share, with their rows in
// the table. A verb takes the rows that mean something for it.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "exit_code.hpp"
#include "g4lidar/export/point_writer.hpp"
#include "g4lidar/export/time_shift.hpp"
#include "g4lidar/filter.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/recording/writer.hpp"
#include "g4lidar/scan_shaper.hpp"
#include "g4lidar/too_near.hpp"
#include "rows.hpp"
#include "verbs.hpp"

namespace g4_tool {

enum class color_choice : unsigned char { automatic, always, never };

/// Set once, by the command line.
struct global_options {
  bool quiet = false;    ///< Only errors on standard error.
  bool verbose = false;  ///< Messages about each step.
  bool json_errors = false;
  color_choice color = color_choice::automatic;
};

[[nodiscard]] global_options& our_global_options() noexcept;

/// -q, -v, --color, --json-errors.
[[nodiscard]] option_rows global_rows();
/// --help and --version.
[[nodiscard]] option_rows standard_rows();

/// Whether what is written to `descriptor` is to be coloured: a terminal, no NO_COLOR, or --color.
[[nodiscard]] bool wants_color(int descriptor) noexcept;

/// What a command does when its device is not connected.
enum class loss_rule : unsigned char {
  exit,       ///< It ends.
  reconnect,  ///< It continues when the device is connected again.
  wait,       ///< It also waits for a device that is not connected yet.
};

struct common_options {
  std::string source;        ///< Empty: the only G4.
  std::string output = "-";  ///< `-`: standard output.
  std::uint32_t baud = 230400;
  std::uint64_t count = 0;               ///< So many records, then the end; 0: no end.
  std::chrono::nanoseconds duration{0};  ///< 0: no end.
  std::chrono::nanoseconds idle{0};      ///< The end when nothing has come for so long; 0: never.
  point_filter filter;  ///< But for its frame, which is `frame`, and its ignored sectors.
  std::vector<sector> ignored;
  std::string mask;  ///< The file of --mask; empty: none.
  mark_limits marks;
  grid_options grid;  ///< Of --no-return and --near-as; its frame is not used.
  deskewing deskew = deskewing::none;
  std::string odometry;           ///< The file of --odometry; empty: that of the recording.
  std::optional<mounting> mount;  ///< Where it is given.
  g4lidar::frame frame = g4lidar::frame::vendor;
  length_unit unit = length_unit::millimetres;
  std::optional<time_style> time;  ///< If not given, what suits the source.
  loss_rule on_loss = loss_rule::exit;
  bool json = false;  ///< JSON instead of text.
};

using shared_options = std::shared_ptr<common_options>;

/// The words of lidar_options::device, a file, `-`, or `sim:`; see source.hpp.
[[nodiscard]] option_row source_argument(common_options& options);
[[nodiscard]] option_row output_row(common_options& options);
/// -d.
[[nodiscard]] option_row duration_row(common_options& options);
/// -n, -d, --idle.
[[nodiscard]] option_rows ending_rows(common_options& options, bool with_idle = true);
/// --range, --fov, --ignore, --mask, --speckle, --edges.
[[nodiscard]] option_rows filter_rows(common_options& options);
/// --near.
[[nodiscard]] option_row near_row(std::optional<near_limits>& into);
/// --no-return, --near-as.
[[nodiscard]] option_rows grid_rows(grid_options& into);
/// "X,Y,DEG" or "X,Y,DEG,down" in metres and degrees. Throws bad_value.
[[nodiscard]] mounting mounting_of(const std::string& text);
/// --odometry, --mount.
[[nodiscard]] option_rows motion_rows(common_options& options);
/// --deskew.
[[nodiscard]] option_row deskew_row(common_options& options);
/// --frame, --unit, --time.
[[nodiscard]] option_rows shape_rows(common_options& options);
[[nodiscard]] option_row time_row(common_options& options);
[[nodiscard]] option_row frame_row(const char* name, const char* help, g4lidar::frame& into);
/// --format csv|jsonl|text.
[[nodiscard]] option_row format_row(text_format& into, const char* help = "Output format (text)");
/// --json.
[[nodiscard]] option_row json_row(common_options& options);
/// --compress.
[[nodiscard]] option_row compress_row(packing& into);
[[nodiscard]] option_rows baud_row(common_options& options);
/// --on-loss, whose default is what `options` has now, and --baud.
[[nodiscard]] option_rows device_rows(common_options& options);

}  // namespace g4_tool
