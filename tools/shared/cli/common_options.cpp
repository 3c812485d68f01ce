// SPDX-License-Identifier: MIT
#include "common_options.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "g4lidar/options/filter_text.hpp"
#include "io/command_files.hpp"
#include "logger.hpp"

namespace g4_tool {

global_options& our_global_options() noexcept {
  static global_options ours;
  return ours;
}

option_rows global_rows() {
  global_options& ours = our_global_options();
  return {flag_row("-q,--quiet", "Write only errors to standard error", ours.quiet),
          flag_row("-v,--verbose", "Write messages about each step", ours.verbose),
          choice_row("--color", "When to color the output (auto: on a terminal)", ours.color,
                     choices<color_choice>{{"auto", color_choice::automatic},
                                           {"always", color_choice::always},
                                           {"never", color_choice::never}}),
          flag_row("--json-errors", "Write an error as a JSON object", ours.json_errors)};
}

option_rows standard_rows() {
  return {{"-h,--help", "", "Print a help message and exit"},
          {"--version", "", "Print the version and exit"}};
}

bool wants_color(int descriptor) noexcept {
  if (our_global_options().color != color_choice::automatic) {
    return our_global_options().color == color_choice::always;
  }
  const char* const no_color = std::getenv("NO_COLOR");
  const char* const terminal = std::getenv("TERM");
  if (no_color != nullptr && *no_color != '\0') return false;
  if (terminal != nullptr && std::string_view(terminal) == "dumb") return false;
  return ::isatty(descriptor) != 0;
}

option_row source_argument(common_options& options) {
  return text_row("SOURCE", "", "The lidar, a recording, raw bytes, or sim: (the only lidar)",
                  options.source, completion::source);
}

option_row force_row() {
  return {"--force", "", "Replace an existing file", [](const std::string&) { allow_replacing(); }};
}

option_rows output_rows(common_options& options) {
  return {text_row("-o,--output", "OUT", "Output file; - for standard output (-)", options.output,
                   completion::output),
          force_row()};
}

option_row duration_row(common_options& options, const char* help) {
  return duration_row("-d,--duration", help, options.duration);
}

option_rows ending_rows(common_options& options, bool with_idle) {
  option_rows rows{number_row("-n,--count", "N", "Stop after N records", options.count,
                              std::uint64_t{1}, UINT64_MAX),
                   duration_row(options)};
  if (with_idle)
    rows.push_back(duration_row("--idle", "Stop if no data arrives for this time", options.idle));
  return in_group("End condition", rows);
}

option_row near_row(std::optional<near_limits>& into) {
  option_row row = row_of(*find_parameter("near"), [&into](const std::string& word) {
    filter_settings made;
    store(made, *find_parameter("near"), word);
    into = made.marks.near;
  });
  row.group = "Filters";
  return row;
}

option_rows grid_rows(grid_options& into) {
  option_rows rows;
  for (const char* const name : {"no_return", "near_as"}) {
    rows.push_back(row_of(*find_parameter(name), [&into, name](const std::string& word) {
      filter_settings made{.grid = into};
      store(made, *find_parameter(name), word);
      into = made.grid;
    }));
  }
  return in_group("Ranges without return", rows);
}

void note_order(scan_order chosen) {
  if (chosen != scan_order::time) return;
  logger::info(
      "--order time is not for slam_toolbox, which would make a wrong map: it takes the angles of "
      "all scans as those of the first one, and as symmetrical about 0\n");
}

option_rows direction_rows(common_options& options) {
  filter_settings& into = options;
  option_rows rows = rows_of("Filters", {"fov", "ignore"}, into);
  rows.back().take = [&into](const std::string& word) {
    filter_settings more;
    if (word.empty()) throw bad_value("the value is empty; give directions: 30:40");
    store(more, *find_parameter("ignore"), word);
    into.ignored.insert(into.ignored.end(), more.ignored.begin(), more.ignored.end());
  };
  rows.back().help += "; may be repeated";
  rows.back().repeatable = true;
  return rows;
}

point_filter directions_of(const common_options& options) {
  point_filter made = options.complete_filter();
  made.in = options.frame;
  return made;
}

option_rows filter_rows(common_options& options) {
  filter_settings& into = options;
  return joined(rows_of("Filters", {"range"}, into), direction_rows(options),
                rows_of("Filters", {"mask"}, options.mask),
                rows_of("Filters", {"speckle", "edges"}, into));
}

mounting mounting_of(const std::string& text) {
  const auto made = mounting_in(text);
  if (const auto* wrong = std::get_if<std::string>(&made)) throw bad_value(*wrong);
  return std::get<mounting>(made);
}

option_row mount_row(common_options& options) {
  return row_of(*find_parameter("mount"),
                [&into = options.mount](const std::string& word) { into = mounting_of(word); });
}

option_rows motion_rows(common_options& options) {
  return in_group("Motion of the robot",
                  {text_row("--odometry", "FILE", "Poses: lines of time_ns, x, y and yaw_rad",
                            options.odometry, completion::input),
                   mount_row(options)});
}

option_row frame_row(const char* name, const char* help, frame& into) {
  return choice_row(name, help, into,
                    choices<frame>{{"vendor", frame::vendor}, {"robot", frame::robot}});
}

option_row time_row(common_options& options) {
  return choice_row("--time", "Wall clock, monotonic, since the previous or first record (abs)",
                    options.time,
                    choices<time_style>{{"abs", time_style::absolute},
                                        {"mono", time_style::monotonic},
                                        {"delta", time_style::delta},
                                        {"zero", time_style::zero}});
}

option_rows shape_rows(common_options& options) {
  return in_group(
      "Output form",
      {frame_row("--frame", "vendor: clockwise from 0 of the lidar; robot: REP 103 (vendor)",
                 options.frame),
       choice_row(
           "--unit", "Unit of ranges (mm)", options.unit,
           choices<length_unit>{{"mm", length_unit::millimetres}, {"m", length_unit::metres}}),
       time_row(options)});
}

option_row format_row(text_format& into, const char* help) {
  return choice_row(
      "-f,--format", help, into,
      choices<text_format>{
          {"csv", text_format::csv}, {"jsonl", text_format::jsonl}, {"text", text_format::text}});
}

option_rows device_rows(common_options& options) {
  const choices<loss_rule> rules{
      {"exit", loss_rule::exit}, {"wait", loss_rule::wait}, {"reconnect", loss_rule::reconnect}};
  const auto usual =
      std::ranges::find(rules, options.on_loss.usual, &choices<loss_rule>::value_type::second);
  const std::string help = "If the device is lost; wait: also at the start (" + usual->first + ")";
  return joined(
      in_group("Device", {choice_row("--on-loss", help.c_str(), options.on_loss.given, rules)}),
      rows_of("Device",
              {"baud", "model", "zero_angle", "listen_only", "leave_dtr", "probe_all_ports"},
              options.expected));
}

option_rows player_rows(double& speed, bool& loops) {
  return joined(rows_of("Recordings", {"speed"}, speed), rows_of("Recordings", {"loop"}, loops));
}

option_row json_row(common_options& options, const char* help) {
  return flag_row("--json", help, options.json);
}

option_row compress_row(packing& into) {
  return value_row("--compress", "", "Compress a recording with zstd", into,
                   [](const std::string&) {
                     if (!has_zstd()) throw bad_value("this g4-dump was built without zstd");
                     return packing::zstd;
                   });
}

}  // namespace g4_tool
