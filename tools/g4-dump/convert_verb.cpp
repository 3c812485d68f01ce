// SPDX-License-Identifier: MIT
// The options of convert.
#include <map>
#include <memory>
#include <string>

#include "convert_command.hpp"
#include "values.hpp"
#include "verbs.hpp"

namespace g4_dump {
namespace {

constexpr const char* details =
    R"(What IN is, its contents and its name tell: a recording (.mcap), csv, jsonl, else raw bytes. What OUT
is to be, its name tells: .mcap, .bin or .raw, .csv, .jsonl or .ndjson, .pcd; a directory or a name such as
scan-%04d.pcd takes a pcd file for each revolution.
Points of a recording are those of the driver that was recorded, with their times; --time abs makes
these times of day. Raw bytes tell no times: these are counted at --rate, from 0. From csv and jsonl,
a line for each point as g4-dump writes them, csv, jsonl and pcd can be made; bytes they have none.
From a recording to another one, all that went over the line is kept, and the LaserScans are made anew.
--from and --to count from the beginning of IN. Where IN is damaged or was cut off, what is whole is
converted, and the rest counted on standard error. The memory it takes does not depend on the length.
A file that OUT names appears, or is replaced, when all went well, and not before; ^C ends it with
what came so far.)";

using shared = std::shared_ptr<convert_options>;

const std::map<std::string, file_form>& forms() {
  static const std::map<std::string, file_form> known{{"mcap", file_form::recording},
                                                      {"bin", file_form::raw_bytes},
                                                      {"csv", file_form::csv},
                                                      {"jsonl", file_form::jsonl},
                                                      {"pcd", file_form::pcd}};
  return known;
}

std::vector<option_row> form_rows(const shared& options) {
  std::vector<option_row> rows;
  rows.push_back({.names = "--from-format",
                  .value = "mcap|bin|csv|jsonl",
                  .help = "What IN is (what it looks like)",
                  .take =
                      [options](const std::string& word) {
                        options->from = choice_of(word, forms());
                        if (options->from == file_form::pcd) {
                          throw bad_value("pcd is written, but not read");
                        }
                      },
                  .complete = completion::choices});
  rows.push_back(
      {.names = "--to-format",
       .value = "mcap|bin|csv|jsonl|pcd",
       .help = "What OUT is to be (what its name says)",
       .take = [options](const std::string& word) { options->to = choice_of(word, forms()); },
       .complete = completion::choices});
  rows.push_back({.names = "--from",
                  .value = "TIME",
                  .help = "Leave out what came before: 10s",
                  .take = [options](const std::string& word) {
                    options->range.from_ns = moment_of(word).count();
                  }});
  rows.push_back({.names = "--to",
                  .value = "TIME",
                  .help = "And from here on: 40s",
                  .take = [options](const std::string& word) {
                    options->range.to_ns = moment_of(word).count();
                  }});
  return rows;
}

std::vector<option_row> point_rows(const shared& options) {
  std::vector<option_row> rows;
  rows.push_back(
      {.names = "--scans",
       .value = "",
       .help = "A record for each revolution, in csv and jsonl",
       .take = [options](const std::string&) { options->scans = options->shapes = true; }});
  rows.push_back({.names = "--ascii",
                  .value = "",
                  .help = "pcd as text",
                  .take = [options](const std::string&) { options->is_ascii = true; }});
  rows.push_back({.names = "--rate",
                  .value = "HZ",
                  .help = "Samples a second of raw bytes (9000)",
                  .take = [options](const std::string& word) {
                    options->rate_hz = number_of(word, std::uint32_t{1}, std::uint32_t{1'000'000});
                  }});
  rows.push_back({.names = "--from-frame",
                  .value = "vendor|robot",
                  .help = "That the angles in csv and jsonl are in (vendor)",
                  .take =
                      [options](const std::string& word) {
                        options->from_frame = choice_of<g4lidar::frame>(
                            word,
                            {{"vendor", g4lidar::frame::vendor}, {"robot", g4lidar::frame::robot}});
                      },
                  .complete = completion::choices});
  rows.push_back({.names = "--compress",
                  .value = "",
                  .help = "Pack a recording with zstd",
                  .take = [options](const std::string&) {
                    if (!g4lidar::has_zstd()) {
                      throw bad_value("this g4-dump was built without zstd");
                    }
                    options->made.packed = g4lidar::packing::zstd;
                  }});
  return rows;
}

/// Rows that make sense for points only.
std::vector<option_row> shaping(std::vector<option_row> rows, const shared& options) {
  for (option_row& row : rows) {
    row.take = [options, take = row.take](const std::string& word) {
      options->shapes = true;
      take(word);
    };
  }
  return rows;
}

}  // namespace

verb make_convert_verb() {
  const auto options = std::make_shared<convert_options>();
  verb made;
  made.name = "convert";
  made.summary = "Recordings, raw bytes, csv, jsonl and pcd, from one to another";
  made.arguments.push_back(
      {.name = "IN",
       .help = "A recording, raw bytes, csv or jsonl",
       .take = [options](const std::string& word) { options->common->source = word; },
       .complete = completion::file,
       .required = true});
  made.arguments.push_back(
      {.name = "OUT",
       .help = "The file to make; - with --to-format: standard output",
       .take = [options](const std::string& word) { options->common->output = word; },
       .complete = completion::file,
       .required = true});
  append(made.options, form_rows(options));
  append(made.options, point_rows(options));
  append(made.options, shaping(filter_rows(options->common), options));
  append(made.options, shaping(shape_rows(options->common), options));
  made.details = details;
  made.examples = {"g4-dump convert walk.mcap walk.csv --from 10s --to 40s",
                   "g4-dump convert walk.mcap scans/scan-%04d.pcd --frame robot",
                   "g4-dump convert walk.mcap walk.bin",
                   "g4-dump convert walk.bin walk.mcap --compress",
                   "g4-dump convert walk.csv walk.jsonl --range 0.28:16"};
  made.exits = {0, 2, 10, 130};
  made.run = [options] { return run(*options); };
  return made;
}

}  // namespace g4_dump
