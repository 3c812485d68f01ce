// SPDX-License-Identifier: MIT
// The options of decode.
#include <memory>

#include "decode_command.hpp"
#include "values.hpp"
#include "verbs.hpp"

namespace g4_dump {
namespace {

constexpr const char* details =
    R"(Columns of csv: scan (0, and one more with each start of a revolution that is not the first
packet), angle_deg (clockwise, 0 at the cable, below 360), range_mm (0.00: nothing came back),
time_ns (since the first point: raw bytes carry no times, so it is counted at --rate; samples of
suspect packets count, samples that were lost do not). More columns may follow these.
jsonl adds to each point no_return, too_near, and partial: its revolution was not seen whole. It
is therefore written revolution by revolution.
--scans: csv and text have a line, jsonl an object with all points, for each revolution. Columns of
csv: scan, time_ns (of its first point), points, returns (points from which something came back),
partial (true, false), why (what makes it partial, joined by +: start_missing, end_missing,
data_lost, turn_short), turned_deg (how far the angle went, about 360), reported_hz and measured_hz
(of the rotation; empty where not known).

A file that OUT names appears when all went well, and not before. ^C ends a recording in good
order: what came so far is written.)";

std::vector<option_row> rows_of(const std::shared_ptr<decode_options>& options) {
  std::vector<option_row> rows;
  rows.push_back({.names = "-o,--output",
                  .value = "OUT",
                  .help = "Where to write; - or nothing: standard output",
                  .take = [options](const std::string& word) { options->output = word; },
                  .complete = completion::file});
  rows.push_back({.names = "-f,--format",
                  .value = "csv|jsonl|text",
                  .help = "How to write (csv); text is for people",
                  .take =
                      [options](const std::string& word) {
                        options->style.format =
                            choice_of<text_format>(word, {{"csv", text_format::csv},
                                                          {"jsonl", text_format::jsonl},
                                                          {"text", text_format::text}});
                      },
                  .complete = completion::choices});
  rows.push_back({.names = "--scans",
                  .value = "",
                  .help = "A record for each revolution, not each point",
                  .take = [options](const std::string&) { options->style.scans = true; }});
  rows.push_back({.names = "--valid",
                  .value = "",
                  .help = "Leave out the points from which nothing came back",
                  .take = [options](const std::string&) { options->style.valid_only = true; }});
  rows.push_back({.names = "--rate",
                  .value = "HZ",
                  .help = "Samples a second, from which time_ns is counted (9000)",
                  .take = [options](const std::string& word) {
                    options->style.rate_hz =
                        number_of(word, std::uint32_t{1}, std::uint32_t{1'000'000});
                  }});
  rows.push_back({.names = "--stats",
                  .value = "words|json",
                  .help = "The counts at the end, on standard error (words)",
                  .take =
                      [options](const std::string& word) {
                        options->stats = choice_of<stats_format>(
                            word, {{"words", stats_format::words}, {"json", stats_format::json}});
                      },
                  .complete = completion::choices});
  return rows;
}

}  // namespace

verb make_decode_verb() {
  const auto options = std::make_shared<decode_options>();
  verb made;
  made.name = "decode";
  made.summary = "Raw bytes from the port to points";
  made.arguments.push_back(
      {.name = "FILE",
       .help = "Bytes as they came from the port; - or nothing: standard input",
       .take = [options](const std::string& word) { options->input = word; },
       .complete = completion::file});
  made.options = rows_of(options);
  made.details = details;
  made.examples = {
      "g4-dump decode walk.bin -o walk.csv",
      "g4-dump decode walk.bin --format jsonl --scans --valid",
      "g4-dump sim --seconds 60 | g4-dump decode --format text --scans",
      "stty -F /dev/ttyUSB0 230400 raw -echo && g4-dump decode /dev/ttyUSB0 --format text",
      "tail -c +1 -f growing.bin | g4-dump decode -"};
  made.exits = {0, 2, 10, 130};
  made.run = [options] { return run(*options); };
  return made;
}

}  // namespace g4_dump
