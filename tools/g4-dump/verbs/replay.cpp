// SPDX-License-Identifier: MIT
// The verb replay: plays a recording at its own or another speed, or verifies it.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "io/input.hpp"
#include "io/interrupt.hpp"
#include "io/point_run.hpp"
#include "io/recorder.hpp"
#include "verbs/dump_verbs.hpp"

namespace g4_tool {
namespace {

constexpr const char* replay_details =
    R"(The recording passes through the same code as the data of a lidar, so the points and their
times are the same. The output is that of g4-dump dump and g4-dump scan; see there for the columns.
With --loop, times and revolution numbers continue.

--verify writes no points. It checks that the bytes and points of the file are those that were
recorded: exit code 0, or 10 if they differ or the file was cut off and has no digest.
The points of another kind of processor may differ in their last digits: then only their number
is compared. Points that another version of g4-dump computed are not compared. Of a recording in
several files, the bytes of each can be verified.)";

struct replay_verb_options {
  point_options job;
  bool verify = false;
};

[[noreturn]] void refuse(const std::string& sentences) {
  throw failure(exit_code::bad_file, sentences);
}

/// Plays the file and computes the digests again: they must equal those in the file.
void verify(const std::string& path) {
  const std::string title = in_quotes(path);
  recording_job job;
  job.common.source = path;
  job.path = "/dev/null";
  job.made.overwrite = true;
  job.made.scans = job.shows_counts = false;
  const recorded_result result = record(job);
  if (interrupt() != 0) return;
  if (result.damage.any()) {
    logger::info(describe(result.damage));
    refuse(title + " is damaged. Its undamaged part can still be played.");
  }
  if (!result.recorded) refuse(title + " has no digest: it cannot be verified.");
  const recorded_digest& found = result.digest;
  const recorded_digest& wanted = *result.recorded;
  if (found.payload != wanted.payload) {
    refuse(
        fmt::format("the bytes in {} are not those that were recorded: their digest is "
                    "{:016x}, not {:016x}. Do not rely on it.",
                    title, found.payload, wanted.payload));
  }
  logger::info(fmt::format(
      "{} both ways as recorded: {:016x}\n",
      counted(result.file.bytes_from_device + result.file.bytes_to_device, "byte"), found.payload));
  if (wanted.point_count == 0) return logger::info("it has no digest of points\n");
  if (!wanted.is_same_version) {
    return logger::info(
        "its points were computed by another version of g4-dump and are not compared; its bytes "
        "and "
        "times are as recorded\n");
  }
  const bool is_other = wanted.is_comparable && found.points != wanted.points;
  if (is_other || found.point_count != wanted.point_count) {
    refuse(
        fmt::format("{} gives {} points with the digest {:016x}, and gave {} with {:016x} when "
                    "it was recorded. Its bytes are as they were.",
                    title, found.point_count, found.points, wanted.point_count, wanted.points));
  }
  const std::string points = counted(found.point_count, "point");
  logger::info(wanted.is_comparable
                   ? fmt::format("{} as recorded: {:016x}\n", points, found.points)
                   : points +
                         " as recorded; their digest is that of another processor, which "
                         "rounds differently\n");
}

int run(const replay_verb_options& options) {
  const std::string& name = options.job.common->source;
  if (!std::filesystem::exists(path_of_source(name))) {
    refuse("there is no file " + in_quotes(name) + ". Check the name.");
  }
  if (kind_of_source(name) != source_kind::recording) {
    refuse(
        in_quotes(name) +
        " is not a recording. Give a file made by g4-dump record; g4-dump dump reads raw bytes.");
  }
  if (!options.verify) return run(options.job);
  verify(path_of_source(name));
  return exit_code_now();
}

}  // namespace

verb make_replay_verb() {
  const auto options = std::make_shared<replay_verb_options>();
  point_options& job = options->job;
  common_options& common = *job.common;
  playback_options& played = job.source.playback;
  played.speed = 1.0;
  option_row verification =
      flag_row("--verify", "Check that the file holds what was recorded", options->verify);
  verification.excludes = {"--playback-speed", "--loop",  "--from",  "--to",       "--output",
                           "--format",         "--scans", "--count", "--duration", "--model"};
  return {
      .name = "replay",
      .summary = "Play a recording at its own speed or another, or verify it",
      .arguments = {file_argument("FILE", "A recording", common.source, completion::input)},
      .options =
          joined(output_rows(common), format_row(job.form.style.format),
                 flag_row("--scans", "Whole revolutions, not points", job.form.style.scans),
                 value_row("--playback-speed", "1|max|FACTOR",
                           "1: as recorded, 0.5: half as fast (1)", played.speed,
                           [](const std::string& word) {
                             return word == "max" ? 0.0 : number_of(word, 0.001, 1000.0);
                           }),
                 row_of("loop", played.loop),
                 moment_row("--from", "Begin at this time of the recording: 10s", played.from_ns),
                 moment_row("--to", "End at this time of the recording: 40s", played.to_ns),
                 row_of("model", common.expected), row_of("zero_angle", common.expected),
                 verification, ending_rows(common), filter_rows(common),
                 near_row(common.marks.near), shape_rows(common)),
      .details = replay_details,
      .examples = {{"g4-dump replay walk.mcap", "Print the points at the speed of the recording"},
                   {"g4-dump replay walk.mcap --playback-speed max -f csv -o walk.csv",
                    "Write all points to a csv file"},
                   {"g4-dump replay walk.mcap --scans --from 10s --to 40s --playback-speed 0.5",
                    "Print the revolutions of 30 s at half the speed"},
                   {"g4-dump replay --verify walk.mcap", "Check the file"}},
      .run = [options] { return run(*options); }};
}

}  // namespace g4_tool
