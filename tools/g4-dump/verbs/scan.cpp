// SPDX-License-Identifier: MIT
// The verb scan: whole revolutions of any source.
#include <fmt/format.h>

#include <memory>
#include <string>
#include <tuple>
#include <utility>

#include "io/point_help.hpp"
#include "io/point_job.hpp"
#include "verbs/verbs.hpp"

namespace g4_tool {
namespace {

constexpr const char* formats_text =
    R"(--grid N writes N ranges at equal steps of 360/N degrees, from 0 degrees on, in the robot frame
from -180. Columns of csv: scan, time_ns, partial, and range_mm_0 or range_m_0 to range_mm_N-1.
inf: no return, or what --no-return sets; it does not mean that the way is free: what is nearer
than 0.28 m may give no return. nan: unknown, because the direction is left out, or the return is
outside the range or below 100 mm (unless --range includes it), or --near flags the direction, which
is -inf with --near-as minus-inf. jsonl: angle_min_deg, angle_step_deg, and ranges_mm or ranges_m,
with "inf", null and "-inf" for these.

-f pcd writes a PCD 0.7 file with the returns of one revolution: x, y, z in meters, range_m,
angle_deg, time_ns. In the vendor frame x points to 0 and y to 90 degrees clockwise; in the
robot frame x points ahead and y to the left. -f svg writes a picture, seen from above, with ahead
at the top and a circle at each meter. If OUT contains %d or %04d, or is a directory, each
revolution gets a numbered file; else the first one is written and the command ends.)";

}  // namespace

verb make_scan_verb() {
  const auto job = std::make_shared<point_job>();
  job->style.scans = true;
  common_options& common = *job->common;
  option_row format = format_row(job->style.format);
  const choices<std::pair<scan_file, text_format>> forms{
      {"csv", {scan_file::none, text_format::csv}},
      {"jsonl", {scan_file::none, text_format::jsonl}},
      {"pcd", {scan_file::pcd, text_format::text}},
      {"svg", {scan_file::svg, text_format::text}},
      {"text", {scan_file::none, text_format::text}}};
  format.value = words_of(forms, "|");
  format.take = [into = job.get(), known = forms](const std::string& word) {
    std::tie(into->file, into->style.format) = choice_of(word, known);
  };
  return {
      .name = "scan",
      .summary = "Print whole revolutions",
      .arguments = {source_argument(common)},
      .options = joined(
          output_row(common), format,
          number_row("--grid", "N", "Write N ranges at equal angles, no points", job->bins,
                     std::size_t{1}, std::size_t{65'536}),
          flag_row("--partial", "Write pieces of revolutions, too", job->partial),
          choice_row("--pcd-data", "Data of pcd files (binary)", job->data,
                     choices<pcd_data>{{"binary", pcd_data::binary}, {"ascii", pcd_data::ascii}}),
          sample_rate_row(job->source.raw_sample_rate_hz), ending_rows(common), filter_rows(common),
          near_row(common.marks.near), grid_rows(common.grid), shape_rows(common),
          device_rows(common)),
      .details =
          fmt::format("{}\n\n{}\n\n{}\n\n{}", scan_columns, formats_text, shape_text, ending_text),
      .examples = {{"g4-dump scan -n 5", "Print five revolutions"},
                   {"g4-dump scan 'sim:?seed=7' -d 3s -f csv",
                    "Three seconds of a simulated G4 as csv"},
                   {"g4-dump scan --grid 720 --frame robot --unit m -f jsonl",
                    "Ranges at steps of half a degree, as JSON"},
                   {"g4-dump scan -n 10 -f pcd -o scan-%04d.pcd", "Ten point clouds in ten files"},
                   {"g4-dump scan sim: -f svg -o scan.svg", "A picture of one revolution"}},
      .run = [job] { return run(*job); }};
}

}  // namespace g4_tool
