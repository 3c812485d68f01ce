// SPDX-License-Identifier: MIT
// The verb convert.
#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "g4lidar/recording/writer.hpp"
#include "io/input.hpp"
#include "io/interrupt.hpp"
#include "io/output.hpp"
#include "io/point_run.hpp"
#include "io/read_loop.hpp"
#include "io/recorder.hpp"
#include "io/text_input.hpp"
#include "verbs/copied_bytes.hpp"
#include "verbs/dump_verbs.hpp"

namespace g4_tool {
namespace {

/// In this order: bytes, points that are read and written, points that are only written.
enum class file_form : unsigned char {
  recording,
  raw_bytes,
  csv,
  jsonl,
  pcd,
  npy,
  npz,
  ply,
  xyz,
  carmen,
  tum
};

struct convert_options {
  point_options points;           ///< Its source is IN, its output OUT; also for bytes.
  std::optional<file_form> from;  ///< Nothing: by its contents and name.
  std::optional<file_form> to;    ///< Nothing: by its name.
  g4lidar::frame text_frame = g4lidar::frame::vendor;  ///< Of the angles in csv and jsonl.
  bool shapes = false;                                 ///< An option for points was given.
  recording_options made;                              ///< Of a written recording.

  [[nodiscard]] const std::string& in() const noexcept { return points.common->source; }
  [[nodiscard]] const std::string& out() const noexcept { return points.common->output; }
  [[nodiscard]] const playback_options& range() const noexcept { return points.source.playback; }
};

/// The first four are read and written, the others are written; the last two are other names.
const choices<file_form>& forms() {
  static const choices<file_form> all{
      {"mcap", file_form::recording}, {"bin", file_form::raw_bytes}, {"csv", file_form::csv},
      {"jsonl", file_form::jsonl},    {"pcd", file_form::pcd},       {"npy", file_form::npy},
      {"npz", file_form::npz},        {"ply", file_form::ply},       {"xyz", file_form::xyz},
      {"carmen", file_form::carmen},  {"tum", file_form::tum},       {"ndjson", file_form::jsonl},
      {"raw", file_form::raw_bytes}};
  return all;
}

std::optional<file_form> form_of_name(const std::string& name) {
  for (const auto& [word, form] : forms()) {
    if (name.ends_with("." + word)) return form;
  }
  return std::nullopt;
}

file_form form_of_input(const convert_options& options) {
  const std::string& name = options.in();
  const source_kind kind = kind_of_source(name);
  if (kind == source_kind::device && !std::filesystem::exists(path_of_source(name))) {
    throw failure(exit_code::bad_file, "there is no file " + in_quotes(name) +
                                           ". Check the name. For a lidar, use g4-dump dump or "
                                           "g4-dump record.");
  }
  if (kind == source_kind::simulated || kind == source_kind::device) {
    throw bad_value(in_quotes(name) + " is not a file: use dump or record");
  }
  const bool is_recording = kind == source_kind::recording;
  const file_form by_contents =
      is_recording ? file_form::recording : form_of_name(name).value_or(file_form::raw_bytes);
  const file_form form = options.from.value_or(by_contents);
  if (form >= file_form::pcd) throw bad_value("this format is written, but not read");
  if (form == file_form::recording && !is_recording) {
    throw failure(exit_code::bad_file,
                  in_quotes(name) + " is not a recording. Give a file made by g4-dump record.");
  }
  return form;
}

file_form form_of_output(const convert_options& options) {
  const std::string& name = options.out();
  std::error_code unknown;
  if (options.to) return *options.to;
  if (name.ends_with('/') || std::filesystem::is_directory(name, unknown)) return file_form::pcd;
  if (const auto form = form_of_name(name)) return *form;
  throw bad_value(
      fmt::format("'{}' does not end in .mcap, .bin, .csv, .jsonl, .pcd, .npy, .npz, .ply, "
                  ".xyz, .carmen or .tum; give its format with --to-format",
                  name));
}

void check_combination(const convert_options& options, file_form form, file_form to) {
  const bool to_points = to >= file_form::csv;
  if (form >= file_form::csv && !to_points) {
    throw bad_value(
        fmt::format("{} holds points, not bytes of a lidar: it can be converted to other formats "
                    "of points, but not to raw bytes or a recording",
                    in_quotes(options.in())));
  }
  if (!to_points && options.shapes) {
    throw bad_value(
        "raw bytes and recordings hold what the lidar sent: --range, --fov, --ignore, "
        "--mask, --speckle, --edges, --deskew, --frame, --unit, --time and --scans are for "
        "points");
  }
  const recording_options& made = options.made;
  const bool has_messages = !made.points_topic.empty() || made.order == scan_order::time ||
                            made.grid.no_return != no_return_as::infinity ||
                            made.grid.near_is_minus_infinity;
  if (to != file_form::recording && has_messages) {
    throw bad_value("--points, --order, --no-return and --near-as are for recordings");
  }
  const bool keeps_bytes =
      to == file_form::raw_bytes || (to == file_form::recording && form == file_form::recording);
  if (keeps_bytes && options.points.common->expected.zero_angle) {
    throw bad_value(
        "the bytes stay as they are: --zero-angle is for points, and for a recording of raw bytes");
  }
  if (to == file_form::raw_bytes && !options.points.common->odometry.empty()) {
    throw bad_value("raw bytes hold no odometry: --odometry is for recordings and points");
  }
  const bool ends_at_its_begin = to == file_form::recording || to == file_form::npy ||
                                 to == file_form::npz || to == file_form::ply;
  if (ends_at_its_begin && options.out() == "-") {
    throw bad_value(fmt::format("{} is written to a file, not to standard output",
                                to == file_form::recording ? "a recording" : "this format"));
  }
}

int to_points(convert_options options, file_form given, file_form to) {
  using enum point_file_format;
  static const std::map<file_form, point_file_format> point_files{
      {file_form::npy, npy}, {file_form::npz, npz}, {file_form::ply, ply}, {file_form::xyz, xyz}};
  point_options& job = options.points;
  output_form& form = job.form;
  if (to == file_form::pcd) form.file = scan_file::pcd;
  if (const auto at = point_files.find(to); at != point_files.end()) form.point_file = at->second;
  if (to == file_form::tum) form.log = slam_log::tum;
  if (to == file_form::carmen) form.log = slam_log::carmen;
  job.common->marks.near = options.made.near;
  job.partial = to != file_form::pcd && form.log == slam_log::none;
  form.style.format = to == file_form::csv ? text_format::csv : text_format::jsonl;
  if (given < file_form::csv) return run(job);
  const bool is_csv = given == file_form::csv;
  return convert_text(job, is_csv ? text_source::csv : text_source::jsonl, options.text_frame);
}

int to_bytes(const convert_options& options, file_form form) {
  output out(options.out());
  if (out.is_terminal()) {
    throw failure(exit_code::usage, "raw bytes are not for a terminal. Give a file as OUT.");
  }
  const std::uint64_t count = form == file_form::recording ? copy_recording(options.points, out)
                                                           : copy_bytes(options.points, out);
  if (count == 0 && interrupt() == 0) throw nothing_to_write(title_of_input(options.in()), false);
  if (count > 0) out.commit();
  return exit_code_now();
}

failure why_empty(const convert_options& options, const recorded_result& result) {
  const bool is_from_a_time = options.range().from_ns > 0;
  if (is_from_a_time || kind_of_source(options.in()) == source_kind::recording)
    return no_packet_in(options.in(), is_from_a_time);
  return without_packets(result.lidar.stream, result.lidar.bytes,
                         beginning_of(path_of_source(options.in())), title_of_input(options.in()));
}

int to_recording(const convert_options& options) {
  output out(options.out());
  recording_job job;
  job.common = *options.points.common;
  job.source = options.points.source;
  job.path = out.place();
  job.made = options.made;
  job.made.overwrite = true;
  job.is_kept = false;
  job.title = options.out();
  const recorded_result result = record(job);
  if (result.lidar.stream.packets == 0 && interrupt() == 0) throw why_empty(options, result);
  if (result.lidar.stream.packets == 0) return exit_code_now();
  out.commit();
  report_counts(result.lidar);
  const std::string path = path_of_source(options.in());
  if (path != "-" && kind_of_source(options.in()) == source_kind::raw_bytes)
    logger::info(warning_about(result.lidar.stream, result.lidar.bytes, beginning_of(path)));
  logger::info(describe(result.damage));
  report_recorded(result, job.title);
  return exit_code_now();
}

int run(const convert_options& options) {
  const file_form from = form_of_input(options);
  const file_form to = form_of_output(options);
  check_combination(options, from, to);
  if (options.range().to_ns <= std::max<std::int64_t>(options.range().from_ns, 0))
    throw bad_value("--to is not after --from, or after the beginning");
  if (to == file_form::recording) return to_recording(options);
  if (to == file_form::raw_bytes) return to_bytes(options, from);
  return to_points(options, from, to);
}

constexpr const char* convert_details =
    R"(IN is a recording, csv or jsonl as g4-dump writes them for points, else raw bytes. If OUT is a
directory or a name such as scan-%04d.pcd, each revolution gets a pcd file. npy, npz (NumPy), ply
and xyz have all points. carmen is a log for SLAM programs: each revolution as 1440 ranges. tum has
the pose of the robot at each revolution. The poses are those of --odometry, or of the recording.

Points of a recording are those of the driver that was recorded, with their times. Raw bytes
have no times: they are counted from 0 with --sample-rate. Times in csv and jsonl stay as they
are. From a recording to a recording, all bytes both ways and the odometry are kept, and the other
messages are computed again: see --points, --order, --odometry and --mount of g4-dump record.

--from and --to count from the beginning of IN. Of a damaged IN the undamaged part is converted,
and the rest is counted on standard error. OUT appears when everything is written; --force
replaces an existing file, but never IN. ^C ends the command; what was converted so far is written.)";

option_rows form_rows(convert_options& options) {
  const choices<file_form> inputs(forms().begin(), forms().begin() + 4);
  const choices<file_form> outputs(forms().begin(), forms().end() - 2);
  point_options& job = options.points;
  playback_options& range = job.source.playback;
  return {
      choice_row("--from-format", "Format of IN (by its contents and name)", options.from, inputs),
      choice_row("--to-format", "Format of OUT (by its name)", options.to, outputs),
      force_row(),
      moment_row("--from", "Begin at this time of IN: 10s", range.from_ns),
      moment_row("--to", "End at this time of IN: 40s", range.to_ns),
      value_row("--ascii", "", "Write pcd as text", job.form.data,
                [](const std::string&) { return pcd_data::ascii; }),
      row_of("model", job.common->expected),
      row_of("zero_angle", job.common->expected),
      row_of("raw_sample_rate_hz", job.source.raw_sample_rate_hz),
      frame_row("--from-frame", "Frame of the angles in csv and jsonl (vendor)",
                options.text_frame),
      compress_row(options.made.packed)};
}

/// The rows of the options for points.
option_rows point_rows(convert_options& options) {
  common_options& common = *options.points.common;
  option_rows rows = joined(flag_row("--scans", "A record for each revolution, in csv and jsonl",
                                     options.points.form.style.scans),
                            filter_rows(common), shape_rows(common),
                            rows_of("Motion of the robot", {"deskew"}, common.deskew));
  for (option_row& row : rows) {
    row = checked(std::move(row), [&options](const std::string&) { options.shapes = true; });
  }
  return rows;
}

}  // namespace

verb make_convert_verb() {
  const auto options = std::make_shared<convert_options>();
  common_options& common = *options->points.common;
  options->points.whole_file = true;
  options->points.form.style = {};
  return {
      .name = "convert",
      .summary = "Convert recordings, raw bytes and points",
      .arguments = {file_argument("IN", "A recording, raw bytes, csv or jsonl", common.source,
                                  completion::input),
                    file_argument("OUT", "The file to write; - with --to-format: standard output",
                                  common.output, completion::output)},
      .options = joined(form_rows(*options), message_rows(options->made), motion_rows(common),
                        point_rows(*options)),
      .details = convert_details,
      .examples =
          {{"g4-dump convert walk.mcap walk.csv --from 10s --to 40s", "The points of 30 s as csv"},
           {"g4-dump convert walk.mcap scans/scan-%04d.pcd --frame robot",
            "A point cloud for each revolution"},
           {"g4-dump convert walk.mcap walk.bin", "The bytes that the lidar sent"},
           {"g4-dump convert walk.bin walk.mcap --compress", "Raw bytes to a compressed recording"},
           {"g4-dump convert way.bin way.mcap --odometry way.txt",
            "Raw bytes and odometry to a recording"},
           {"g4-dump convert walk.csv walk.jsonl --range 0.28:16", "The near returns as JSON"}},
      .exits = {0, 2, 10, 130},
      .run = [options] { return run(*options); }};
}

}  // namespace g4_tool
