// SPDX-License-Identifier: MIT
// The verbs that print points: dump of any source, scan for whole revolutions, decode for files.
#include <fmt/format.h>

#include <memory>
#include <string>
#include <tuple>
#include <utility>

#include "g4lidar/transport/source.hpp"
#include "io/point_run.hpp"
#include "verbs/dump_verbs.hpp"

namespace g4_tool {
namespace {

constexpr const char* shape_text =
    R"(  --range FROM:TO  A point without a return has the range 0: it is left out unless FROM is 0.
  --fov, --ignore  Directions in the frame of the output, both ends included: 350:10 is 20 degrees
                   around 0; in the robot frame -90:90 is the half in front.
  --mask FILE      Lines "polygon x1 y1 x2 y2 x3 y3 ...": corners in meters, x ahead, y to the left,
                   whatever --frame is; # begins a comment.
  --speckle[=LIMITS]  A return is left out if fewer than count of the samples up to window before
                   and after it are returns near it: within near meters, or within ratio times its
                   range. The default is window=2,count=1,near=0.05, and a ratio of 0.05, or more if
                   the samples are more than 0.28 degrees apart.
  --edges[=LIMITS]  A return is left out if, up to window samples away, a nearer one is on one side
                   and a farther one on the other, and the lines to both make an angle below angle
                   degrees with the beam. The default is window=1,angle=5.
  --near[=LIMITS]  A direction without return is flagged may_be_too_near if in the last revolutions
                   a return came from there from less than twice the shortest range of the lidar,
                   and none that is farther since. The default is revolutions=3, and the
                   shortest range of the model, 0.28 for a G4 (of revolutions that at their sample
                   rate, of single points that at the usual one);
                   revolutions=0: until a return comes from there.
  --frame vendor   Angles grow clockwise seen from above, 0 at the cable, in [0, 360).
  --frame robot    Angles grow counter-clockwise, 0 ahead (opposite the cable), in [-180, 180).
  --time abs       Since 1970, by the clock of the computer (default).
  --time mono      Time of the monotonic clock.
  --time zero      Since the first record.
  --time delta     Since the previous record that was written.

Raw bytes have no times: times are counted from the first sample with --sample-rate; abs and
mono are refused.)";

constexpr const char* ending_text =
    R"(From a lidar or a pipe, OUT is created (with --force also replaced) with the first record and
grows. From a file, OUT appears when everything is written. ^C stops the lidar; the records so far
are written. With --on-loss reconnect or wait the command waits for a lost lidar, until --idle ends
it; with wait also for one that is not connected yet. For files, -d counts the times of the
points.)";

constexpr const char* point_columns =
    R"(Columns of csv:
  scan       number of the revolution
  angle_deg  direction of the point
  range_mm   distance (range_m with --unit m); 0: no return, which is not free space
  time_ns    time of the point
  intensity, sample_flags  what the samples of another --model contain: the strength of the return,
             and two flags, 0 to 3, whose meaning is not known for certain

More columns may follow in later versions. jsonl has the same names, and no_return and too_near
(below 100 mm: not reliable); not_deskewed, unlikely, isolated, veiling and may_be_too_near only if
they are true. text is for people.)";

constexpr const char* scan_columns =
    R"(A record is a revolution, with flags if data is missing; with --partial also a piece of one.

Columns of csv:
  scan         number of the revolution
  time_ns      time of its first point
  points       number of points
  returns      number of points with a return
  partial      true or false
  why          why it is partial, joined by +: start_missing, end_missing, data_lost, turn_short,
               crc_mismatch, and where a zero packet was lost start_by_angle, end_by_angle
  turned_deg   angle between the first and the last point, about 360
  reported_hz  scan frequency as the lidar reports it; empty if unknown
  measured_hz  scan frequency as measured; empty if unknown

More columns may follow in later versions. jsonl: an object with the same names, and all points
in arrays: angle_deg, range_mm or range_m, time_ns.)";

constexpr const char* formats_text =
    R"(--grid N writes N ranges at equal steps of 360/N degrees, from 0 degrees on, in the robot frame
from -180. Columns of csv: scan, time_ns, partial, and range_mm_0 or range_m_0 to range_mm_N-1.
inf: no return, or what --no-return sets; it does not mean that the way is free: what is nearer
than the shortest range (0.28 m for a G4) may give no return. nan: unknown, because the direction
is left out, or the return is outside the range or too near (unless --range includes it), or --near
flags the direction, which is -inf with --near-as minus-inf. jsonl: angle_min_deg, angle_step_deg,
and ranges_mm or ranges_m, with "inf", null and "-inf" for these.

-f pcd writes a PCD 0.7 file with the returns of one revolution: x, y, z in meters, range_m,
angle_deg, time_ns, and intensity if the model has it. In the vendor frame x points to 0 and y to
90 degrees clockwise; in the robot frame x points ahead and y to the left. -f svg writes a
picture, seen from above, with ahead at the top and a circle at each meter. If OUT contains %d or
%04d, or is a directory, each revolution gets a numbered file; else the first one is written and
the command ends.)";

constexpr const char* decoding =
    R"(The same as g4-dump dump with a file as SOURCE, but: the default input is standard input, the
default format is csv, a device file such as /dev/ttyUSB0 is read as raw bytes, and OUT appears
when everything is written.

time_ns is counted from the first point with --sample-rate. Samples of suspect packets count,
lost samples do not. jsonl adds partial to each point: its revolution is not whole. So the points
are written revolution by revolution.)";

}  // namespace

verb make_dump_verb() {
  const auto job = std::make_shared<point_options>();
  common_options& common = *job->common;
  const auto refuse_pcd = [](const std::string& word) {
    if (word == "pcd") throw bad_value("'pcd' is a format of revolutions: use g4-dump scan");
  };
  return {.name = "dump",
          .summary = "Print points (the default command)",
          .arguments = {source_argument(common)},
          .options =
              joined(output_rows(common), checked(format_row(job->form.style.format), refuse_pcd),
                     row_of("raw_sample_rate_hz", job->source.raw_sample_rate_hz),
                     ending_rows(common), filter_rows(common), near_row(common.marks.near),
                     shape_rows(common), device_rows(common)),
          .details = fmt::format("{}\n\n{}\n\n{}", point_columns, shape_text, ending_text),
          .examples = {{"g4-dump", "Print the points of the only lidar"},
                       {"g4-dump -n 1000 -f csv -o points.csv", "Write 1000 points to a csv file"},
                       {"g4-dump --frame robot --fov -90:90 --range 0.28:16 --unit m",
                        "Print the points in front of the lidar, in meters"},
                       {"g4-dump dump sim: -d 2s -f jsonl",
                        "Print 2 s of points of a simulated G4 as JSON"}},
          .run = [job] { return run(*job); }};
}

verb make_scan_verb() {
  const auto job = std::make_shared<point_options>();
  job->form.style.scans = true;
  common_options& common = *job->common;
  option_row format = format_row(job->form.style.format);
  const choices<std::pair<scan_file, text_format>> forms{
      {"csv", {scan_file::none, text_format::csv}},
      {"jsonl", {scan_file::none, text_format::jsonl}},
      {"pcd", {scan_file::pcd, text_format::text}},
      {"svg", {scan_file::svg, text_format::text}},
      {"text", {scan_file::none, text_format::text}}};
  format.value = words_of(forms, "|");
  format.take = [into = job.get(), known = forms](const std::string& word) {
    std::tie(into->form.file, into->form.style.format) = choice_of(word, known);
  };
  return {
      .name = "scan",
      .summary = "Print whole revolutions",
      .arguments = {source_argument(common)},
      .options = joined(
          output_rows(common), format,
          number_row("--grid", "N", "Write N ranges at equal angles, no points", job->form.bins,
                     std::size_t{1}, std::size_t{65'536}),
          flag_row("--partial", "Write pieces of revolutions, too", job->partial),
          choice_row("--pcd-data", "Data of pcd files (binary)", job->form.data,
                     choices<pcd_data>{{"binary", pcd_data::binary}, {"ascii", pcd_data::ascii}}),
          row_of("raw_sample_rate_hz", job->source.raw_sample_rate_hz), ending_rows(common),
          filter_rows(common), near_row(common.marks.near), grid_rows(common.grid),
          shape_rows(common), device_rows(common)),
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

verb make_decode_verb() {
  const auto job = std::make_shared<point_options>();
  job->form.style = {.format = text_format::csv};
  job->partial = job->whole_file = true;
  job->common->source = "-";
  common_options& common = *job->common;
  const auto as_file = [](const std::string& word) {
    return kind_of_source(word) == source_kind::device ? std::string("file:").append(word) : word;
  };
  option_row file = value_row("FILE", "", "Raw bytes or a recording; - for standard input (-)",
                              common.source, as_file);
  file.complete = completion::input;
  return {.name = "decode",
          .summary = "Print the points of a file (dump with other defaults)",
          .arguments = {file},
          .options =
              joined(output_rows(common), format_row(job->form.style.format, "Output format (csv)"),
                     flag_row("--scans", "A record for each revolution", job->form.style.scans),
                     flag_row("--valid", "Leave out points without a return", job->returns_only),
                     row_of("model", common.expected), row_of("zero_angle", common.expected),
                     row_of("raw_sample_rate_hz", job->source.raw_sample_rate_hz),
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
