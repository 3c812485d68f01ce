// SPDX-License-Identifier: MIT
// The verb record.
#include <memory>
#include <string>
#include <vector>

#include "common_options.hpp"
#include "exit_code.hpp"
#include "file_id.hpp"
#include "interrupt.hpp"
#include "live.hpp"
#include "manners.hpp"
#include "played_points.hpp"
#include "recorder.hpp"
#include "values.hpp"
#include "verbs.hpp"

namespace g4_dump {
namespace {

constexpr const char* details =
    R"(OUT is an MCAP file: the raw bytes both ways with their times, and beside them each revolution as a
sensor_msgs/msg/LaserScan, which Foxglove and ros2 bag show. It can be read while it grows; after a
crash at most a second is missing. One argument alone that ends in .mcap is OUT, with the only G4 as
SOURCE. A file that is there already stays as it is, but for --force.
With --rotate-size or --rotate-time walk.mcap is followed by walk-0001.mcap, and so on; each can be
opened by itself.
SOURCE may be a recording: what comes of it holds the same bytes in the same order, and has the same
digest, which is shown at the end and kept in the file (see g4-dump replay --verify). Raw bytes in a
file tell no times: these are counted at --rate, from the last change of the file on.
^C ends the file properly. A disk that is full ends it, too; what was written by then can be read.)";

struct record_options {
  shared_options common = std::make_shared<common_options>();
  std::vector<std::string> words;  // SOURCE and OUT, or one of them
  std::string out;
  recording_job job;
};

using shared = std::shared_ptr<record_options>;

bool ends_as_recording(const std::string& word) { return word.ends_with(".mcap"); }

/// Tells SOURCE from OUT.
void sort_words(record_options& options) {
  std::vector<std::string> words = options.words;
  if (options.out.empty() &&
      (words.size() == 2 || (words.size() == 1 && ends_as_recording(words[0])))) {
    options.out = words.back();
    words.pop_back();
  }
  if (words.size() > 1) throw bad_value(in_quotes(words.back()) + " is one argument too many");
  if (options.out.empty()) {
    throw bad_value("say where to record to: g4-dump record SOURCE -o walk.mcap");
  }
  if (options.out == "-")
    throw bad_value("a recording is written to a file, not to standard output");
  if (!words.empty()) options.common->source = words.front();
}

int run(record_options& options) {
  sort_words(options);
  options.job.common = *options.common;
  options.job.path = options.out;
  const recorded_result result = record(options.job);
  tell_counts(result.lidar, reading::points);
  tell(words_about(result.damage));
  tell_recorded(result, options.out);
  return interrupt() != 0 ? 128 + interrupt() : static_cast<int>(exit_code::ok);
}

std::vector<option_row> file_rows(const shared& options) {
  const std::string group = "The file";
  std::vector<option_row> rows;
  rows.push_back({.names = "-o,--output",
                  .value = "OUT",
                  .help = "The recording, an MCAP file",
                  .take = [options](const std::string& word) { options->out = word; },
                  .complete = completion::file});
  rows.push_back({.names = "--force",
                  .value = "",
                  .help = "Replace a file that is there already",
                  .take = [options](const std::string&) { options->job.made.overwrite = true; },
                  .group = group});
  rows.push_back({.names = "--compress",
                  .value = "",
                  .help = "Pack it with zstd",
                  .take =
                      [options](const std::string&) {
                        if (!g4lidar::has_zstd()) {
                          throw bad_value("this g4-dump was built without zstd");
                        }
                        options->job.made.packed = g4lidar::packing::zstd;
                      },
                  .group = group});
  rows.push_back({.names = "--rotate-size",
                  .value = "SIZE",
                  .help = "Begin a new file before one is larger: 1G, 500M",
                  .take =
                      [options](const std::string& word) {
                        options->job.made.rotate_bytes = byte_count_of(word);
                        if (options->job.made.rotate_bytes < 1U << 20U) {
                          throw bad_value(in_quotes(word) + " is less than 1M");
                        }
                      },
                  .group = group});
  rows.push_back({.names = "--rotate-time",
                  .value = "TIME",
                  .help = "And after so long: 1h",
                  .take =
                      [options](const std::string& word) {
                        using std::chrono::seconds;
                        const auto time = duration_of(word);
                        if (time < seconds(1))
                          throw bad_value(in_quotes(word) + " is less than 1s");
                        options->job.made.rotate_time = std::chrono::duration_cast<seconds>(time);
                      },
                  .group = group});
  return rows;
}

std::vector<option_row> scan_rows(const shared& options) {
  const std::string group = "The scans in it";
  std::vector<option_row> rows;
  rows.push_back({.names = "--no-scans",
                  .value = "",
                  .help = "Only the bytes, no LaserScan messages",
                  .take = [options](const std::string&) { options->job.scans = false; },
                  .group = group});
  rows.push_back({.names = "--topic",
                  .value = "NAME",
                  .help = "Of the LaserScan messages (/scan)",
                  .take = [options](const std::string& word) { options->job.made.topic = word; },
                  .group = group});
  rows.push_back({.names = "--frame-id",
                  .value = "NAME",
                  .help = "Of the LaserScan messages (laser)",
                  .take = [options](const std::string& word) { options->job.made.frame_id = word; },
                  .group = group});
  rows.push_back({.names = "--rate",
                  .value = "HZ",
                  .help = "Samples a second, where SOURCE is raw bytes in a file (9000)",
                  .take =
                      [options](const std::string& word) {
                        options->job.source.bytes_rate_hz =
                            number_of(word, std::uint32_t{1}, std::uint32_t{1'000'000});
                      },
                  .group = group});
  return rows;
}

}  // namespace

verb make_record_verb() {
  const auto options = std::make_shared<record_options>();
  verb made;
  made.name = "record";
  made.summary = "A recording of all that goes over the line, and of the scans";
  const auto take = [options](const std::string& word) { options->words.push_back(word); };
  argument_row source = source_argument(options->common);
  source.take = take;
  made.arguments.push_back(source);
  made.arguments.push_back({.name = "OUT",
                            .help = "The recording, as -o has it",
                            .take = take,
                            .complete = completion::file});
  append(made.options, file_rows(options));
  append(made.options, scan_rows(options));
  append(made.options, ending_rows(options->common));
  append(made.options, device_rows(options->common));
  made.details = details;
  made.examples = {"g4-dump record walk.mcap", "g4-dump record /dev/ttyUSB0 -o walk.mcap -d 10min",
                   "g4-dump record -o day.mcap --compress --rotate-time 1h --on-loss wait",
                   "g4-dump record 'sim:?seed=7' -n 20 room.mcap"};
  made.run = [options] { return run(*options); };
  return made;
}

}  // namespace g4_dump
