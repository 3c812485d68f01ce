// SPDX-License-Identifier: MIT
// The verb dump: the points of any source.
#include <fmt/format.h>

#include <memory>
#include <string>

#include "io/point_help.hpp"
#include "io/point_job.hpp"
#include "verbs/verbs.hpp"

namespace g4_tool {

verb make_dump_verb() {
  const auto job = std::make_shared<point_job>();
  common_options& common = *job->common;
  const auto refuse_pcd = [](const std::string& word) {
    if (word == "pcd") throw bad_value("'pcd' is a format of revolutions: use g4-dump scan");
  };
  return {.name = "dump",
          .summary = "Print points (the default command)",
          .arguments = {source_argument(common)},
          .options = joined(output_row(common), checked(format_row(job->style.format), refuse_pcd),
                            sample_rate_row(job->source.raw_sample_rate_hz), ending_rows(common),
                            filter_rows(common), near_row(common.marks.near), shape_rows(common),
                            device_rows(common)),
          .details = fmt::format("{}\n\n{}\n\n{}", point_columns, shape_text, ending_text),
          .examples = {{"g4-dump", "Print the points of the only G4"},
                       {"g4-dump -n 1000 -f csv -o points.csv", "Write 1000 points to a csv file"},
                       {"g4-dump --frame robot --fov -90:90 --range 0.28:16 --unit m",
                        "Print the points in front of the lidar, in meters"},
                       {"g4-dump dump sim: -d 2s -f jsonl",
                        "Print 2 s of points of a simulated G4 as JSON"}},
          .run = [job] { return run(*job); }};
}

}  // namespace g4_tool
