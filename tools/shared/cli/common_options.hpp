// SPDX-License-Identifier: MIT
// The global options of every verb, and the options that several verbs share, with their rows of the
// table. Each verb uses the rows that apply to it.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "exit_code.hpp"
#include "g4lidar/filter/too_near.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/lidar_options.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/options/filter_text.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/recording/writer.hpp"
#include "g4lidar/scan_shaper.hpp"
#include "option_rows.hpp"
#include "verbs.hpp"
#include "written_form.hpp"

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

/// Whether output to `descriptor` is coloured: by --color, else if it is a terminal and NO_COLOR is
/// not set.
[[nodiscard]] bool wants_color(int descriptor) noexcept;

/// What a command does if its device is not connected.
enum class loss_rule : unsigned char {
  exit,       ///< Ends.
  reconnect,  ///< Waits for a lost device and continues.
  wait,       ///< Also waits for a device that is not connected at the start.
};

struct loss_choice {
  loss_rule usual = loss_rule::exit;  ///< Of the command.
  std::optional<loss_rule> given;     ///< Of --on-loss.
};

/// The filters are those of filter_settings: without a frame, which is below, and a mask.
struct common_options : filter_settings {
  std::string source;        ///< Empty: the only lidar.
  std::string output = "-";  ///< `-`: standard output.
  lidar_options
      expected;  ///< How it is opened: all that the user gives, but loss, playback and settings.
  std::uint64_t count = 0;               ///< The largest number of records; 0: no limit.
  std::chrono::nanoseconds duration{0};  ///< 0: no limit.
  std::chrono::nanoseconds idle{0};      ///< The longest time without data; 0: no limit.
  std::string mask;                      ///< The file of --mask; empty: none.
  deskewing deskew = deskewing::none;
  std::string odometry;  ///< The file of --odometry; empty: that of the recording.
  std::optional<mounting> mount;
  g4lidar::frame frame = g4lidar::frame::vendor;
  length_unit unit = length_unit::millimetres;
  std::optional<time_style> time;  ///< Nothing: the default depends on the source.
  loss_choice on_loss;
  bool json = false;
};

using shared_options = std::shared_ptr<common_options>;

/// The argument SOURCE: see transport/source.hpp.
[[nodiscard]] option_row source_argument(common_options& options);
/// --force, of each verb that writes a file.
[[nodiscard]] option_row force_row();
/// -o, --force.
[[nodiscard]] option_rows output_rows(common_options& options);
/// -d.
[[nodiscard]] option_row duration_row(common_options& options,
                                      const char* help = "Stop after this time: 10s, 500ms, 2min");
/// -n, -d, --idle.
[[nodiscard]] option_rows ending_rows(common_options& options, bool with_idle = true);
/// --fov, --ignore.
[[nodiscard]] option_rows direction_rows(common_options& options);
/// The filter with its frame and its ignored sectors, a view of `options`.
[[nodiscard]] point_filter directions_of(const common_options& options);
/// --range, --fov, --ignore, --mask, --speckle, --edges.
[[nodiscard]] option_rows filter_rows(common_options& options);
/// --near.
[[nodiscard]] option_row near_row(std::optional<near_limits>& into);
/// --no-return, --near-as.
[[nodiscard]] option_rows grid_rows(grid_options& into);
/// Logs for which program the order of time is not.
void note_order(scan_order chosen);
/// "X,Y,DEG" or "X,Y,DEG,down" in metres and degrees. Throws bad_value.
[[nodiscard]] mounting mounting_of(const std::string& text);
/// --mount.
[[nodiscard]] option_row mount_row(common_options& options);
/// --odometry, --mount.
[[nodiscard]] option_rows motion_rows(common_options& options);
/// --frame, --unit, --time.
[[nodiscard]] option_rows shape_rows(common_options& options);
[[nodiscard]] option_row time_row(common_options& options);
[[nodiscard]] option_row frame_row(const char* name, const char* help, g4lidar::frame& into);
/// --format csv|jsonl|text.
[[nodiscard]] option_row format_row(text_format& into, const char* help = "Output format (text)");
/// --playback-speed and --loop of a recording.
[[nodiscard]] option_rows player_rows(double& speed, bool& loops);
/// --json.
[[nodiscard]] option_row json_row(common_options& options,
                                  const char* help = "Write JSON, one object in each line");
/// --compress.
[[nodiscard]] option_row compress_row(packing& into);
/// --on-loss with options.on_loss.usual as default, --baud, --model, --zero-angle, --listen, --all-ports.
[[nodiscard]] option_rows device_rows(common_options& options);

}  // namespace g4_tool
