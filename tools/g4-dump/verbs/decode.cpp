// SPDX-License-Identifier: MIT
// The verb decode: dump of a file, with other defaults.
#include <fmt/format.h>

#include <memory>
#include <string>

#include "io/point_help.hpp"
#include "io/point_job.hpp"
#include "verbs/verbs.hpp"

namespace g4_tool {
namespace {

constexpr const char* decoding =
    R"(The same as g4-dump dump with a file as SOURCE, but: the default input is standard input, the
default format is csv, a device file such as /dev/ttyUSB0 is read as raw bytes, and OUT appears
when everything is written.

time_ns is counted from the first point with --sample-rate. Samples of suspect packets count,
lost samples do not. jsonl adds partial to each point: its revolution is not whole. So the points
are written revolution by revolution.)";

}  // namespace

verb make_decode_verb() {
  const auto job = std::make_shared<point_job>();
  job->style = {.format = text_format::csv};
  job->partial = job->whole_file = true;
  job->common->source = "-";
  common_options& common = *job->common;
  const auto as_file = [](const std::string& word) {
    return kind_of_source(word) == source_kind::device ? "file:" + word : word;
  };
  option_row file = value_row("FILE", "", "Raw bytes or a recording; - for standard input (-)",
                              common.source, as_file);
  file.complete = completion::file;
  return {.name = "decode",
          .summary = "Print the points of a file (dump with other defaults)",
          .arguments = {file},
          .options =
              joined(output_row(common), format_row(job->style.format, "Output format (csv)"),
                     flag_row("--scans", "A record for each revolution", job->style.scans),
                     flag_row("--valid", "Leave out points without a return", job->returns_only),
                     sample_rate_row(job->source.raw_sample_rate_hz),
                     choice_row("--stats", "Form of the counts on standard error (words)",
                                job->json_counts, choices<bool>{{"words", false}, {"json", true}}),
                     ending_rows(common), filter_rows(common), near_row(common.marks.near),
                     shape_rows(common)),
          .details =
              fmt::format("{}\n\n{}\n\nWith --scans:\n\n{}", decoding, point_columns, scan_columns),
          .examples = {{"g4-dump decode walk.bin -o walk.csv", "Raw bytes to csv"},
                       {"g4-dump decode walk.bin --format jsonl --scans --valid",
                        "The returns of each revolution as JSON"},
                       {"g4-dump sim --seconds 60 | g4-dump decode --format text --scans",
                        "The revolutions of a simulated G4"},
                       {"tail -c +1 -f growing.bin | g4-dump decode -", "A file that grows"}},
          .exits = {0, 2, 10, 130},
          .run = [job] { return run(*job); }};
}

}  // namespace g4_tool
