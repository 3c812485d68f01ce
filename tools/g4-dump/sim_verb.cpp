// SPDX-License-Identifier: MIT
// The options of sim.
#include <memory>

#include "sim_command.hpp"
#include "values.hpp"
#include "verbs.hpp"

namespace g4_dump {
namespace {

using shared = std::shared_ptr<sim_options>;

constexpr const char* details =
    R"(The same options give the same bytes on every computer. The bytes begin with the answer to the
command that starts scanning; whole packets follow, all that were complete before N seconds.
--truth: index, time_ns, scan, first_level_deg, bearing_deg (where the target stands), range_mm
(of the target, exact; 0: there is none), raw (as sent, in quarters of a millimetre).

--link: a whole device that answers commands, on a pseudo-terminal that PATH leads to, instead.)";
constexpr const char* served = "A device on a pseudo-terminal, in real time";

/// A row whose value is a number that lies in a member of the scanner's options.
template <class Value, class Number>
option_row number_row(const shared& options, const char* name, const char* shown, const char* help,
                      Value g4lidar::sim::scanner_options::* member, Number least, Number most) {
  return {.names = name, .value = shown, .help = help, .take = [=](const std::string& word) {
            options->scanner.*member = static_cast<Value>(number_of(word, least, most));
          }};
}

void add_output(const shared& options, std::vector<option_row>& rows) {
  rows.push_back({.names = "--seconds",
                  .value = "N",
                  .help = "How long it scans (10)",
                  .take = [options](const std::string& word) {
                    options->seconds = number_of(word, 0.0, 1e9);
                  }});
  rows.push_back({.names = "--seed",
                  .value = "S",
                  .help = "Of all that is random (1)",
                  .take = [options](const std::string& word) {
                    options->scanner.seed = whole_number_of(word);
                  }});
  rows.push_back({.names = "-o,--output",
                  .value = "FILE",
                  .help = "Where to write; - or nothing: standard output",
                  .take = [options](const std::string& word) { options->output = word; },
                  .complete = completion::file});
  rows.push_back({.names = "--truth",
                  .value = "FILE",
                  .help = "What each sample truly was, as csv",
                  .take = [options](const std::string& word) { options->truth = word; },
                  .complete = completion::file});
  rows.push_back({.names = "--world",
                  .value = "FILE",
                  .help = "The walls (a flat of a few rooms); see docs/sim.md",
                  .take = [options](const std::string& word) { options->world = word; },
                  .complete = completion::file});
}

void add_motion(const shared& options, std::vector<option_row>& rows) {
  rows.push_back({.names = "--frequency",
                  .value = "HZ",
                  .help = "Revolutions a second, 5 to 12 (7)",
                  .take = [options](const std::string& word) {
                    options->scanner.scan_frequency_chz =
                        static_cast<std::uint16_t>(number_of(word, 5.0, 12.0) * 100.0 + 0.5);
                  }});
  rows.push_back({.names = "--rate",
                  .value = "4000|8000|9000",
                  .help = "Samples a second (9000)",
                  .take =
                      [options](const std::string& word) {
                        options->scanner.ranging = choice_of<g4lidar::ranging_frequency>(
                            word, {{"4000", g4lidar::ranging_frequency::khz_4},
                                   {"8000", g4lidar::ranging_frequency::khz_8},
                                   {"9000", g4lidar::ranging_frequency::khz_9}});
                      },
                  .complete = completion::choices});
}

void add_scanner(const shared& options, std::vector<option_row>& rows) {
  using g4lidar::sim::scanner_options;
  add_motion(options, rows);
  rows.push_back({.names = "--samples",
                  .value = "N",
                  .help = "In a packet, 1 to 80 (40)",
                  .take = [options](const std::string& word) {
                    options->scanner.samples_per_packet =
                        number_of(word, std::size_t{1}, std::size_t{80});
                  }});
  rows.push_back({.names = "--start-deg",
                  .value = "DEG",
                  .help = "The angle of the first sample (random)",
                  .take = [options](const std::string& word) {
                    options->scanner.start_deg = number_of(word, -1e9, 1e9);
                  }});
  rows.push_back(number_row(options, "--index-deg", "DEG", "Where a revolution starts (0)",
                            &scanner_options::index_deg, -1e9, 1e9));
  rows.push_back(number_row(options, "--noise-mm", "MM", "Standard deviation of each range (0)",
                            &scanner_options::noise_mm, -1e9, 1e9));
  rows.push_back(number_row(options, "--noise-ratio", "RATIO",
                            "And what each mm of range adds to it (0)",
                            &scanner_options::noise_ratio, -1e9, 1e9));
  rows.push_back(number_row(options, "--dropout", "RATIO",
                            "How many of all samples see nothing for no reason, 0 to 1 (0)",
                            &scanner_options::dropout_ratio, -1e9, 1e9));
  rows.push_back(
      {.names = "--no-reported-frequency",
       .value = "",
       .help = "Packets do not tell the scan frequency",
       .take = [options](const std::string&) { options->scanner.reports_frequency = false; }});
}

/// The options that make it serve ptys, and those that then mean nothing.
void add_served(const shared& options, std::vector<option_row>& rows) {
  const auto list = [&](std::vector<std::string> sim_options::* values, const char* name,
                        const char* shown, const char* help) {
    rows.push_back({.names = name,
                    .value = shown,
                    .help = help,
                    .take = [options, values](
                                const std::string& word) { ((*options).*values).push_back(word); },
                    .repeatable = true,
                    .group = served});
    return &rows.back();
  };
  option_row* const link = list(&sim_options::links, "--link", "PATH",
                                "Serve a device here, until ^C; again for one more");
  link->complete = completion::file;
  link->excludes = {"--seconds", "--output", "--truth"};
  list(&sim_options::serials, "--serial", "DIGITS", "Of the devices, in turn: 16 digits each")
      ->needs = {"--link"};
  list(&sim_options::faults, "--fault", "FAULT",
       "KIND[=AMOUNT][*RATE][@BEGIN[+DURATION]]; see docs/sim.md")
      ->needs = {"--link"};
  rows.push_back({.names = "--log",
                  .value = "",
                  .help = "What they are asked, on standard error",
                  .take = [options](const std::string&) { options->log = true; },
                  .group = served,
                  .needs = {"--link"}});
}

}  // namespace

verb make_sim_verb() {
  const auto options = std::make_shared<sim_options>();
  verb made;
  made.name = "sim";
  made.summary = "The bytes that a G4 in a world of walls would send";
  add_output(options, made.options);
  add_scanner(options, made.options);
  add_served(options, made.options);
  made.details = details;
  made.examples = {
      "g4-dump sim --seconds 60 --seed 7 -o room.bin --truth room.csv",
      "g4-dump sim --seconds 5 --noise-mm 8 --dropout 0.02 | g4-dump decode --format text",
      "g4-dump sim --link /tmp/lidar --log",
      "g4-dump sim --link /tmp/front --link /tmp/rear --fault unplug@5s+2s --fault 'flip*0.01%'"};
  made.exits = {0, 2, 10, 130};
  made.run = [options] { return run(*options); };
  return made;
}

}  // namespace g4_dump
