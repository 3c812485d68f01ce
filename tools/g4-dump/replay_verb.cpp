// SPDX-License-Identifier: MIT
// The verb replay: a recording at the pace at which it was made, or another; and whether it is whole.
#include <memory>
#include <string>

#include "dump_command.hpp"
#include "exit_code.hpp"
#include "file_id.hpp"
#include "interrupt.hpp"
#include "source.hpp"
#include "values.hpp"
#include "verbs.hpp"
#include "verify.hpp"

namespace g4_dump {
namespace {

constexpr const char* details =
    R"(The recording goes through the same code as a lidar, to the same points with the same times, and is
written as g4-dump dump and scan write them; see there for the columns.
--rate max: as fast as it goes, which is what dump does with a recording. --loop: for ever; times and
the numbers of revolutions go on.
--verify writes no points, but plays the file and says whether its bytes and its points are those that
were recorded: exit code 0, or 10 where they are not, or where it does not say what it should hold
because it was cut off. The points of another kind of processor may differ in their last digits: then
their number is compared. Of a recording in several files, the bytes of each can be verified.)";

struct replay_verb_options {
  dump_options dump;
  bool verify = false;
};

using shared = std::shared_ptr<replay_verb_options>;

int run(const replay_verb_options& options) {
  const std::string& name = options.dump.common->source;
  if (kind_of(name) != source_kind::recording) {
    throw failure(exit_code::bad_file,
                  in_quotes(name) +
                      " is no recording. Give a file that g4-dump record made; raw "
                      "bytes are read by g4-dump dump.");
  }
  if (!options.verify) return run(options.dump);
  verify(path_of(name));
  return interrupt() != 0 ? 128 + interrupt() : static_cast<int>(exit_code::ok);
}

double rate_of(const std::string& word) {
  if (word == "max") return 0.0;
  return number_of(word, 0.001, 1000.0);
}

std::vector<option_row> playing_rows(const shared& options) {
  g4lidar::replay_options& played = options->dump.source.played;
  std::vector<option_row> rows;
  rows.push_back(
      {.names = "--rate",
       .value = "1|max|FACTOR",
       .help = "How fast: 1 as recorded, 0.5 half as fast (1)",
       .take = [options, &played](const std::string& word) { played.rate = rate_of(word); }});
  rows.push_back({.names = "--loop",
                  .value = "",
                  .help = "Again and again",
                  .take = [options, &played](const std::string&) { played.loop = true; }});
  rows.push_back({.names = "--from",
                  .value = "TIME",
                  .help = "Leave out what was recorded before: 10s",
                  .take = [options, &played](const std::string& word) {
                    played.range.from_ns = moment_of(word).count();
                  }});
  rows.push_back({.names = "--to",
                  .value = "TIME",
                  .help = "And from here on: 40s",
                  .take = [options, &played](const std::string& word) {
                    played.range.to_ns = moment_of(word).count();
                  }});
  rows.push_back({.names = "--verify",
                  .value = "",
                  .help = "Whether it holds what was recorded; no points",
                  .take = [options](const std::string&) { options->verify = true; },
                  .excludes = {"--rate", "--loop", "--from", "--to", "--output", "--format",
                               "--scans", "--count", "--duration"}});
  return rows;
}

std::vector<option_row> writing_rows(const shared& options) {
  std::vector<option_row> rows;
  rows.push_back(output_row(options->dump.common));
  rows.push_back({.names = "-f,--format",
                  .value = "csv|jsonl|text",
                  .help = "How to write (text)",
                  .take =
                      [options](const std::string& word) {
                        options->dump.style.format =
                            choice_of<text_format>(word, {{"csv", text_format::csv},
                                                          {"jsonl", text_format::jsonl},
                                                          {"text", text_format::text}});
                      },
                  .complete = completion::choices});
  rows.push_back({.names = "--scans",
                  .value = "",
                  .help = "Whole revolutions, not points",
                  .take = [options](const std::string&) { options->dump.style.scans = true; }});
  return rows;
}

}  // namespace

verb make_replay_verb() {
  const auto options = std::make_shared<replay_verb_options>();
  options->dump.source.played.rate = 1.0;
  verb made;
  made.name = "replay";
  made.summary = "A recording at its own pace, or another; --verify: whether it is as recorded";
  made.arguments.push_back(
      {.name = "FILE",
       .help = "A recording",
       .take = [options](const std::string& word) { options->dump.common->source = word; },
       .complete = completion::file,
       .required = true});
  append(made.options, writing_rows(options));
  append(made.options, playing_rows(options));
  append(made.options, ending_rows(options->dump.common));
  append(made.options, filter_rows(options->dump.common));
  append(made.options, shape_rows(options->dump.common));
  made.details = details;
  made.examples = {"g4-dump replay walk.mcap",
                   "g4-dump replay walk.mcap --rate max -f csv -o walk.csv",
                   "g4-dump replay walk.mcap --scans --from 10s --to 40s --rate 0.5",
                   "g4-dump replay --verify walk.mcap"};
  made.run = [options] { return run(*options); };
  return made;
}

}  // namespace g4_dump
