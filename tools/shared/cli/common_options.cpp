// SPDX-License-Identifier: MIT
#include "common_options.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "g4lidar/filter_text.hpp"
#include "g4lidar/lidar_options.hpp"
#include "io/command_files.hpp"
#include "logger.hpp"
#include "suggestion.hpp"

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

option_row duration_row(common_options& options) {
  return duration_row("-d,--duration", "Stop after this time: 10s, 500ms, 2min", options.duration);
}

option_rows ending_rows(common_options& options, bool with_idle) {
  option_rows rows{number_row("-n,--count", "N", "Stop after N records", options.count,
                              std::uint64_t{1}, UINT64_MAX),
                   duration_row(options)};
  if (with_idle)
    rows.push_back(duration_row("--idle", "Stop if no data arrives for this time", options.idle));
  return in_group("End condition", rows);
}

namespace {

/// The name in `text`, a word or limits, that is none of `known`.
std::string unknown_name(std::string_view text, const std::vector<std::string>& known) {
  while (!text.empty()) {
    const std::string_view piece = text.substr(0, text.find(','));
    text.remove_prefix(std::min(piece.size() + 1, text.size()));
    std::string name(piece.substr(0, piece.find('=')));
    if (std::ranges::find(known, name) == known.end()) return name;
  }
  return {};
}

/// Sets a filter by its text. Throws bad_value.
void take_filter(filter_settings& into, std::string_view name, const std::string& text) {
  const std::string wrong = set_filter(into, name, text);
  if (wrong.empty()) return;
  const auto words = filter_words(name);
  const std::vector<std::string> known(words.begin(), words.end());
  throw bad_value(wrong + did_you_mean(unknown_name(text, known), known));
}

/// The same for the marks.
void take_marks(mark_limits& into, std::string_view name, const std::string& text) {
  filter_settings now{.marks = into};
  take_filter(now, name, text);
  into = now.marks;
}

/// The option of a filter: "--near-as" of near_as.
option_row filter_row(const char* names, std::string value, const char* help,
                      std::function<void(const std::string&)> take) {
  option_row row{names, std::move(value), help, std::move(take)};
  row.group = "Filters";
  return row;
}

/// A flag whose optional value sets some limits.
option_row limits_row(const char* names, const char* help,
                      std::function<void(const std::string&)> take) {
  option_row row = filter_row(names, "", help, std::move(take));
  row.optional_value = "LIMITS";
  return row;
}

/// Sets the filter of this name by a word.
std::function<void(const std::string&)> taken(common_options& options, std::string_view name) {
  return [&options, name](const std::string& word) {
    filter_settings now{.filter = options.filter, .marks = options.marks};
    take_filter(now, name, word);
    options.filter = now.filter;
    options.marks = now.marks;
  };
}

}  // namespace

option_row near_row(std::optional<near_limits>& into) {
  return limits_row("--near", "Flag directions where something may be too near for a return",
                    [&into](const std::string& word) {
                      mark_limits marks;
                      take_marks(marks, "near", word);
                      into = marks.near;
                    });
}

option_rows grid_rows(grid_options& into) {
  return in_group(
      "Ranges without return",
      {choice_row("--no-return", "What the range of a direction without return becomes (inf)",
                  into.no_return,
                  choices<no_return_as>{{"inf", no_return_as::infinity},
                                        {"nan", no_return_as::nan},
                                        {"max", no_return_as::max}}),
       choice_row("--near-as", "What the range of a direction that --near flags becomes (nan)",
                  into.near_is_minus_infinity,
                  choices<bool>{{"nan", false}, {"minus-inf", true}})});
}

option_row order_row(scan_order& into) {
  return choice_row("--order",
                    "Order of the ranges of a LaserScan; time: z is down, not for slam_toolbox "
                    "(angle)",
                    into,
                    choices<scan_order>{{"angle", scan_order::angle}, {"time", scan_order::time}});
}

void note_order(scan_order chosen) {
  if (chosen != scan_order::time) return;
  logger::info(
      "--order time is not for slam_toolbox, which would make a wrong map: it takes the angles of "
      "all scans as those of the first one, and as symmetrical about 0\n");
}

option_rows direction_rows(common_options& options) {
  option_row ignore = filter_row(
      "--ignore", "FROM:TO", "Leave out these directions: 30:40; may be repeated",
      [&options](const std::string& word) {
        filter_settings more;
        take_filter(more, "ignore", word);
        options.ignored.insert(options.ignored.end(), more.ignored.begin(), more.ignored.end());
      });
  ignore.repeatable = true;
  return in_group("Filters", {filter_row("--fov", "FROM:TO",
                                         "Keep these directions, in degrees of the frame: -90:90",
                                         taken(options, "fov")),
                              ignore});
}

point_filter directions_of(const common_options& options) {
  point_filter made = options.filter;
  made.in = options.frame;
  made.ignored_sectors = options.ignored;
  return made;
}

option_rows filter_rows(common_options& options) {
  return in_group(
      "Filters",
      joined(filter_row("--range", "FROM:TO", "Keep returns in this range, in meters: 0.28:16",
                        taken(options, "range")),
             direction_rows(options),
             text_row("--mask", "FILE", "Leave out returns inside the polygons of a file",
                      options.mask, completion::input),
             limits_row("--speckle", "Leave out returns without another one near them",
                        taken(options, "speckle")),
             limits_row("--edges", "Leave out veiling points at jumps of the range",
                        taken(options, "edges"))));
}

mounting mounting_of(const std::string& text) {
  const auto made = mounting_in(text);
  if (const auto* wrong = std::get_if<std::string>(&made)) throw bad_value(*wrong);
  return std::get<mounting>(made);
}

option_row mount_row(common_options& options) {
  return value_row("--mount", "X,Y,DEG[,down]",
                   "Where the lidar is on the robot; down: top down (0,0,0)", options.mount,
                   mounting_of);
}

option_rows motion_rows(common_options& options) {
  return in_group("Motion of the robot",
                  {text_row("--odometry", "FILE", "Poses: lines of time_ns, x, y and yaw_rad",
                            options.odometry, completion::input),
                   mount_row(options)});
}

option_row deskew_row(common_options& options) {
  option_row row = choice_row(
      "--deskew", "Deskew each revolution by the odometry, or by the scans alone", options.deskew,
      choices<deskewing>{{"odometry", deskewing::by_path}, {"scans", deskewing::by_scans}});
  row.group = "Motion of the robot";
  return row;
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

option_rows baud_row(common_options& options) {
  return in_group("Device", {number_row("--baud", "RATE", "Baud rate (searched, or by --model)",
                                        options.expected.baud, 1U, 10'000'000U)});
}

option_row model_row(common_options& options) {
  return value_row("--model", "MODEL", "x4, x2, ...; x4! insists (searched, or as a file shows)",
                   options.expected.model, [&insists = options.expected.insists](std::string word) {
                     insists = word.ends_with('!');
                     if (insists) word.pop_back();
                     const g4lidar::model* const found = g4lidar::model_named(word);
                     if (found != nullptr) return found;
                     throw bad_value(g4lidar::why_no_model(word));
                   });
}

option_row listen_row(common_options& options) {
  return flag_row("--listen", "Only listen: not a byte is sent", options.expected.listens);
}

option_row all_ports_row(common_options& options) {
  option_row row =
      flag_row("--all-ports", "Without a name: look at all ports, not only at a CP2102",
               options.expected.all_ports);
  row.group = "Device";
  return row;
}

option_row zero_row(common_options& options) {
  return value_row("--zero-angle", "DEG", "Added to all angles, not the answer to command 93",
                   options.expected.zero, [](const std::string& word) {
                     const double cdeg = std::round(100.0 * number_of(word, -360.0, 360.0));
                     return std::optional(g4lidar::zero_angle{static_cast<std::int32_t>(cdeg)});
                   });
}

option_rows device_rows(common_options& options) {
  const choices<loss_rule> rules{
      {"exit", loss_rule::exit}, {"wait", loss_rule::wait}, {"reconnect", loss_rule::reconnect}};
  const auto usual =
      std::ranges::find(rules, options.on_loss.usual, &choices<loss_rule>::value_type::second);
  const std::string help = "If the device is lost; wait: also at the start (" + usual->first + ")";
  return joined(
      in_group("Device", {choice_row("--on-loss", help.c_str(), options.on_loss.given, rules)}),
      baud_row(options), in_group("Device", {model_row(options), zero_row(options)}),
      in_group("Device",
               {listen_row(options), flag_row("--leave-dtr", "Do not set the line DTR of the port",
                                              options.expected.leaves_dtr)}),
      all_ports_row(options));
}

option_row loop_row(bool& into) { return flag_row("--loop", "Start again at the end", into); }

option_rows player_rows(double& speed, bool& loops) {
  return in_group("Recordings",
                  {number_row("--playback-speed", "FACTOR", "1: as recorded, 0.5: half as fast (1)",
                              speed, 0.01, 100.0),
                   loop_row(loops)});
}

option_row json_row(common_options& options) {
  return flag_row("--json", "Write JSON, one object in each line", options.json);
}

option_row compress_row(packing& into) {
  return value_row("--compress", "", "Compress a recording with zstd", into,
                   [](const std::string&) {
                     if (!has_zstd()) throw bad_value("this g4-dump was built without zstd");
                     return packing::zstd;
                   });
}

}  // namespace g4_tool
