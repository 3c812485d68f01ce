// SPDX-License-Identifier: MIT
// The verb record: records a source.
#include <memory>
#include <string>
#include <vector>

#include "cli/common_options.hpp"
#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "cli/option_rows.hpp"
#include "io/command_files.hpp"
#include "io/input.hpp"
#include "io/interrupt.hpp"
#include "io/read_loop.hpp"
#include "io/recorder.hpp"
#include "verbs/dump_verbs.hpp"

namespace g4_tool {
namespace {

constexpr const char* record_details =
    R"(OUT is an MCAP file: the raw bytes both ways with their times, and each revolution as a
sensor_msgs/msg/LaserScan message, which Foxglove and ros2 bag show. It can be read while it
grows; after a crash or on a full disk at most the last second is missing. A single argument that
ends in .mcap is OUT. With --rotate-size or --rotate-time, walk.mcap is followed by
walk-0001.mcap and so on; each can be opened by itself. If there is such a file, it stays, and the
next free number is taken, also with --force. An existing OUT is replaced with --force only, when
the source has been opened.

SOURCE may be a recording: the new one holds the same bytes in the same order and has the same
digest, which is printed at the end and kept in the file (see g4-dump replay --verify). Files of
raw bytes carry no times: times are counted with --sample-rate, from the last change of the file
on.

--points adds each revolution as sensor_msgs/msg/PointCloud2 on /points: x y z, t in ns since the
stamp, range, angle. --order time writes the ranges of a LaserScan as they were measured, with
their real time_increment, in a frame with z down, but not for slam_toolbox. --odometry FILE adds nav_msgs/msg/Odometry on
/odom: lines as sim --odometry writes them, with times of the source's clock (of raw bytes in a
file: since its first byte); a simulated robot adds its own without errors. --mount adds /tf_static from base_link.)";

struct record_options {
  std::vector<std::string> words;  // SOURCE and OUT, or one of them
  recording_job job;
};

/// Separates SOURCE from OUT.
void sort_words(record_options& options) {
  std::vector<std::string> words = options.words;
  std::string& out = options.job.path;
  const bool has_out = words.size() == 2 || (words.size() == 1 && words[0].ends_with(".mcap"));
  if (out.empty() && has_out) {
    out = words.back();
    words.pop_back();
    if (words.empty()) take_back_input(out);  // it was in the place of SOURCE
  }
  if (words.size() > 1) throw bad_value("unexpected argument " + in_quotes(words.back()));
  if (out.empty()) {
    throw bad_value("no output file; give one: g4-dump record SOURCE -o walk.mcap");
  }
  if (out == "-") {
    throw bad_value("a recording is written to a file, not to standard output");
  }
  for (const char* const other : {".csv", ".jsonl", ".ndjson", ".json", ".pcd", ".bin", ".raw"}) {
    if (out.ends_with(other)) {
      throw bad_value(in_quotes(out) +
                      " has the name of another format: record writes MCAP files; record to "
                      "walk.mcap and use g4-dump convert, or g4-dump dump -f csv");
    }
  }
  if (!words.empty()) options.job.common.source = words.front();
}

int run(record_options& options) {
  sort_words(options);
  const recorded_result result = record(options.job);
  report_counts(result.lidar);
  logger::info(describe(result.damage));
  report_recorded(result, options.job.path);
  return exit_code_now();
}

option_rows file_rows(record_options& options) {
  recording_options& made = options.job.made;
  const auto size = [](const std::string& word) {
    const std::uint64_t bytes = byte_count_of(word);
    if (bytes < 1U << 20U) throw bad_value(in_quotes(word) + " is below 1M");
    return bytes;
  };
  const auto time = [](const std::string& word) {
    using std::chrono::seconds;
    const auto given = duration_of(word);
    if (given < seconds(1)) throw bad_value(in_quotes(word) + " is below 1s");
    return std::chrono::duration_cast<seconds>(given);
  };
  return joined(text_row("-o,--output", "OUT", "The recording, an MCAP file", options.job.path,
                         completion::output),
                in_group("The file",
                         {force_row(), compress_row(made.packed),
                          value_row("--rotate-size", "SIZE",
                                    "Start a new file before one exceeds this size: 1G, 500M",
                                    made.rotate_bytes, size),
                          value_row("--rotate-time", "TIME", "Start a new file after this time: 1h",
                                    made.rotate_time, time)}));
}

option_rows scan_rows(record_options& options) {
  recording_options& made = options.job.made;
  const auto name = [](const char* option, const char* help, std::string& into) {
    return text_row(option, "NAME", help, into, completion::nothing);
  };
  const option_rows rows = joined(
      option_rows{value_row("--no-scans", "", "Record the bytes, no LaserScan messages", made.scans,
                            [](const std::string&) { return false; }),
                  name("--topic", "Topic of the LaserScan messages (/scan)", made.topic),
                  name("--frame-id", "frame_id of scans and points (laser)", made.frame_id)},
      message_rows(made), row_of("raw_sample_rate_hz", options.job.source.raw_sample_rate_hz));
  return joined(in_group("Contents", rows), motion_rows(options.job.common));
}

}  // namespace

verb make_record_verb() {
  const auto options = std::make_shared<record_options>();
  common_options& common = options->job.common;
  option_row source = source_argument(common);
  option_row out =
      text_row("OUT", "", "The recording, as with -o", options->job.path, completion::output);
  source.take =
      out.take = [words = &options->words](const std::string& word) { words->push_back(word); };
  return {.name = "record",
          .summary = "Record all bytes both ways, and the scans",
          .arguments = {source, out},
          .options = joined(file_rows(*options), scan_rows(*options), ending_rows(common),
                            device_rows(common)),
          .details = record_details,
          .examples = {{"g4-dump record walk.mcap", "Record the only lidar until ^C"},
                       {"g4-dump record /dev/ttyUSB0 -o walk.mcap -d 10min",
                        "Record one port for ten minutes"},
                       {"g4-dump record -o day.mcap --compress --rotate-time 1h --on-loss wait",
                        "Record for days, a file each hour, also after unplugs"},
                       {"g4-dump record 'sim:?seed=7' -n 20 room.mcap",
                        "Record 20 scans of a simulated G4"},
                       {"g4-dump record walk.mcap slam.mcap --points --mount 0.1,0,180",
                        "Add to a recording what SLAM programs read"}},
          .run = [options] { return run(*options); }};
}

}  // namespace g4_tool
