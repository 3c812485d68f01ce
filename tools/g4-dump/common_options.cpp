// SPDX-License-Identifier: MIT
#include "common_options.hpp"

#include <utility>

namespace g4_dump {
namespace {

constexpr const char* ending = "When it ends";
constexpr const char* filter = "Which points";
constexpr const char* shape = "How they are written";
constexpr const char* device = "The device";

}  // namespace

argument_row source_argument(const shared_options& options) {
  return {.name = "SOURCE",
          .help = "The lidar, a recording, raw bytes, or sim: (the only G4)",
          .take = [options](const std::string& word) { options->source = word; },
          .complete = completion::source};
}

option_row output_row(const shared_options& options) {
  return {.names = "-o,--output",
          .value = "OUT",
          .help = "Where to write; - or nothing: standard output",
          .take = [options](const std::string& word) { options->output = word; },
          .complete = completion::file};
}

std::vector<option_row> ending_rows(const shared_options& options) {
  std::vector<option_row> rows;
  rows.push_back({.names = "-n,--count",
                  .value = "N",
                  .help = "After so many records",
                  .take =
                      [options](const std::string& word) {
                        options->count = number_of(word, std::uint64_t{1}, UINT64_MAX);
                      },
                  .group = ending});
  rows.push_back(
      {.names = "-d,--duration",
       .value = "TIME",
       .help = "After so long: 10s, 500ms, 2min",
       .take = [options](const std::string& word) { options->duration = duration_of(word); },
       .group = ending});
  rows.push_back({.names = "--idle",
                  .value = "TIME",
                  .help = "When nothing has come for so long",
                  .take = [options](const std::string& word) { options->idle = duration_of(word); },
                  .group = ending});
  return rows;
}

std::vector<option_row> filter_rows(const shared_options& options) {
  std::vector<option_row> rows;
  rows.push_back({.names = "--range",
                  .value = "FROM:TO",
                  .help = "Only returns from there, in metres: 0.28:16",
                  .take =
                      [options](const std::string& word) {
                        options->range_m = range_of(word, 0.0, 100.0);
                        if (options->range_m.to < options->range_m.from) {
                          throw bad_value("'" + word + "' ends before it begins");
                        }
                      },
                  .group = filter});
  rows.push_back(
      {.names = "--fov",
       .value = "FROM:TO",
       .help = "Only these directions, degrees of the frame that grow: -90:90",
       .take =
           [options](const std::string& word) { options->fov_deg = range_of(word, -360.0, 360.0); },
       .group = filter});
  rows.push_back({.names = "--ignore",
                  .value = "FROM:TO",
                  .help = "Without these directions: 30:40; can be given again",
                  .take =
                      [options](const std::string& word) {
                        options->ignore_deg.push_back(range_of(word, -360.0, 360.0));
                      },
                  .repeatable = true,
                  .group = filter});
  return rows;
}

std::vector<option_row> shape_rows(const shared_options& options) {
  std::vector<option_row> rows;
  rows.push_back({.names = "--frame",
                  .value = "vendor|robot",
                  .help = "vendor: clockwise from the cable; robot: REP 103 (vendor)",
                  .take =
                      [options](const std::string& word) {
                        options->frame = choice_of<g4lidar::frame>(
                            word,
                            {{"vendor", g4lidar::frame::vendor}, {"robot", g4lidar::frame::robot}});
                      },
                  .complete = completion::choices,
                  .group = shape});
  rows.push_back({.names = "--unit",
                  .value = "mm|m",
                  .help = "Of ranges (mm)",
                  .take =
                      [options](const std::string& word) {
                        options->unit = choice_of<length_unit>(
                            word, {{"mm", length_unit::millimetres}, {"m", length_unit::metres}});
                      },
                  .complete = completion::choices,
                  .group = shape});
  rows.push_back({.names = "--time",
                  .value = "abs|mono|delta|zero",
                  .help = "Since 1970, of the clock, since the last, since the first",
                  .take =
                      [options](const std::string& word) {
                        options->time =
                            choice_of<time_style>(word, {{"abs", time_style::absolute},
                                                         {"mono", time_style::monotonic},
                                                         {"delta", time_style::delta},
                                                         {"zero", time_style::zero}});
                      },
                  .complete = completion::choices,
                  .group = shape});
  return rows;
}

option_row baud_row(const shared_options& options) {
  return {.names = "--baud",
          .value = "RATE",
          .help = "Bits a second (230400)",
          .take =
              [options](const std::string& word) {
                options->baud = number_of(word, std::uint32_t{1}, std::uint32_t{10'000'000});
              },
          .group = device};
}

std::vector<option_row> device_rows(const shared_options& options) {
  std::vector<option_row> rows;
  rows.push_back({.names = "--on-loss",
                  .value = "exit|wait|reconnect",
                  .help = "wait: also for a device that is not there yet (exit)",
                  .take =
                      [options](const std::string& word) {
                        options->on_loss =
                            choice_of<loss_rule>(word, {{"exit", loss_rule::exit},
                                                        {"wait", loss_rule::wait},
                                                        {"reconnect", loss_rule::reconnect}});
                      },
                  .complete = completion::choices,
                  .group = device});
  rows.push_back(baud_row(options));
  return rows;
}

}  // namespace g4_dump
