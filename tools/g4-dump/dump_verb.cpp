// SPDX-License-Identifier: MIT
// The options of dump and scan.
#include <memory>
#include <string>

#include "dump_command.hpp"
#include "values.hpp"
#include "verbs.hpp"

namespace g4_dump {
namespace {

constexpr const char* shaping =
    R"(Points are left out by --range, --fov and --ignore; the numbers of those that stay do not change.
--range: where nothing came back, the range is 0, and so left out unless FROM is 0.
--fov, --ignore: directions as they are written, both ends among them: 350:10 is 20 degrees around
0, and in the robot's frame -90:90 is what lies ahead.
--frame vendor: angles grow clockwise seen from above, 0 at the cable, in [0, 360). Where nothing
came back it is the angle before the correction, as the manual has it.
--frame robot: angles grow counter-clockwise, 0 ahead, opposite the cable, in [-180, 180). Where
nothing came back it is the direction in which nothing was seen.
--time abs: since 1970 (what is used where nothing is said); mono: of the monotonic clock; zero:
since the first that came; delta: since the one written before. Raw bytes carry no times: they are
counted at --rate from the first sample, and abs and mono make no sense for them.)";

constexpr const char* ending =
    R"(The file OUT of a lidar or a pipe is begun, and an older one replaced, when the first record is
there, and grows; that of a file appears when all is well. ^C stops the lidar, and what came so far
is written. With --on-loss reconnect or wait a lidar that was lost is waited for, and --idle ends
that; with wait also one that is not there yet. -d is told by the times of the points where a file
is read.)";

constexpr const char* dump_columns =
    R"(Columns of csv: scan (the number of the revolution), angle_deg, range_mm or with --unit m range_m
(0: nothing came back), time_ns. More may follow these. jsonl has the same names, and no_return and
too_near (below 100 mm, not to be trusted). text is for people.)";

constexpr const char* scan_columns =
    R"(A record is a whole revolution; --partial: also a piece of one.
Columns of csv: scan (the number of the revolution), time_ns (of its first point), points, returns
(points from which something came back), partial (true, false), why (what makes it partial, joined
by +: start_missing, end_missing, data_lost, turn_short), turned_deg (how far the angle went, about
360), reported_hz and measured_hz (of the rotation; empty where not known). More may follow these.
jsonl: an object with the same names, and all points in columns: angle_deg, range_mm or range_m,
time_ns.
--grid N: N ranges at equal steps of 360/N degrees, the first one at 0 degrees, in the robot's frame
at -180. Columns of csv: scan, time_ns, partial, and range_mm_0 or range_m_0 to range_mm_N-1; inf:
nothing came back; nan: not known, because the direction is left out or what came back lies out of
the range or below 100 mm (but for a --range that has it). jsonl: angle_min_deg, angle_step_deg,
and ranges_mm or ranges_m, with "inf" and null for these.
pcd: a PCD 0.7 file with the returns of one revolution: x, y, z (metres; of the vendor's frame x
at 0 and y at 90 degrees clockwise, of the robot's x ahead and y to the left), range_m, angle_deg,
time_ns. A name with %d or %04d, or a directory, makes a numbered file for each revolution; any
other, or standard output, gets the first one, and that is the end.)";

option_row rate_row(const std::shared_ptr<dump_options>& options) {
  return {.names = "--rate",
          .value = "HZ",
          .help = "Samples a second of raw bytes (9000)",
          .take = [options](const std::string& word) {
            options->style.rate_hz = number_of(word, std::uint32_t{1}, std::uint32_t{1'000'000});
          }};
}

void take_format(dump_options& options, const std::string& word) {
  options.pcd = word == "pcd";
  if (options.pcd) return;
  options.style.format = choice_of<text_format>(
      word,
      {{"csv", text_format::csv}, {"jsonl", text_format::jsonl}, {"text", text_format::text}});
}

verb make(const std::shared_ptr<dump_options>& options, const std::string& formats) {
  verb made;
  made.arguments.push_back(source_argument(options->common));
  made.options.push_back(output_row(options->common));
  made.options.push_back({.names = "-f,--format",
                          .value = formats,
                          .help = "How to write (text)",
                          .take =
                              [options, formats](const std::string& word) {
                                if (word == "pcd" && formats.find(word) == std::string::npos) {
                                  throw bad_value("'pcd' holds revolutions; see the verb scan");
                                }
                                take_format(*options, word);
                              },
                          .complete = completion::choices});
  return made;
}

void append_common(verb& made, const std::shared_ptr<dump_options>& options) {
  made.options.push_back(rate_row(options));
  append(made.options, ending_rows(options->common));
  append(made.options, filter_rows(options->common));
  append(made.options, shape_rows(options->common));
  append(made.options, device_rows(options->common));
  made.run = [options] { return run(*options); };
}

}  // namespace

verb make_dump_verb() {
  const auto options = std::make_shared<dump_options>();
  verb made = make(options, "csv|jsonl|text");
  append_common(made, options);
  made.name = "dump";
  made.summary = "Points (the verb that may be left out)";
  made.details = std::string(dump_columns) + "\n" + shaping + "\n" + ending;
  made.examples = {"g4-dump", "g4-dump -n 1000 -f csv -o points.csv",
                   "g4-dump --frame robot --fov -90:90 --range 0.28:16 --unit m",
                   "g4-dump dump sim: -d 2s -f jsonl"};
  return made;
}

verb make_scan_verb() {
  const auto options = std::make_shared<dump_options>();
  options->style.scans = true;
  verb made = make(options, "csv|jsonl|pcd|text");
  made.options.push_back({.names = "--grid",
                          .value = "N",
                          .help = "N ranges for each, at equal steps, and no points",
                          .take = [options](const std::string& word) {
                            options->bins = number_of(word, std::size_t{1}, std::size_t{65'536});
                          }});
  made.options.push_back({.names = "--partial",
                          .value = "",
                          .help = "Pieces of revolutions, too",
                          .take = [options](const std::string&) { options->partial = true; }});
  made.options.push_back({.names = "--pcd-data",
                          .value = "binary|ascii",
                          .help = "What is in the files of -f pcd (binary)",
                          .take =
                              [options](const std::string& word) {
                                options->data = choice_of<pcd_data>(
                                    word,
                                    {{"binary", pcd_data::binary}, {"ascii", pcd_data::ascii}});
                              },
                          .complete = completion::choices});
  append_common(made, options);
  made.name = "scan";
  made.summary = "Whole revolutions";
  made.details = std::string(scan_columns) + "\n" + shaping + "\n" + ending;
  made.examples = {"g4-dump scan -n 5", "g4-dump scan 'sim:?seed=7' -d 3s -f csv",
                   "g4-dump scan --grid 720 --frame robot --unit m -f jsonl",
                   "g4-dump scan -n 10 -f pcd -o scan-%04d.pcd"};
  return made;
}

}  // namespace g4_dump
