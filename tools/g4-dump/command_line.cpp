// SPDX-License-Identifier: MIT
// The verbs and options, declared once; the only place that sees CLI11.
#include "command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <map>
#include <string>
#include <system_error>
#include <vector>

#include "exit_code.hpp"
#include "file_id.hpp"
#include "g4lidar/version.hpp"
#include "say.hpp"

namespace g4_dump {
namespace {

template <class Value>
using names = std::map<std::string, Value>;

const names<text_format> text_formats{
    {"csv", text_format::csv}, {"jsonl", text_format::jsonl}, {"text", text_format::text}};
const names<stats_format> stats_formats{{"words", stats_format::words},
                                        {"json", stats_format::json}};
const names<g4lidar::ranging_frequency> ranging_frequencies{
    {"4000", g4lidar::ranging_frequency::khz_4},
    {"8000", g4lidar::ranging_frequency::khz_8},
    {"9000", g4lidar::ranging_frequency::khz_9}};

/// A range that the help does not spell out. What is no number lies in none.
template <class Value>
CLI::Validator within(Value least, Value most) {
  const auto check = [least, most](const std::string& text) {
    Value value{};
    const bool is_number = CLI::detail::lexical_cast(text, value);
    if (is_number && least <= value && value <= most) return std::string();
    return fmt::format("'{}' is not in the range {} to {}", text, least, most);
  };
  return {check, ""};
}

/// A whole number of 64 bits: one with a sign or too large would be taken for another one.
CLI::Validator whole_number() {
  const auto check = [](const std::string& text) {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc() && end == text.data() + text.size()) return std::string();
    return fmt::format("'{}' is no whole number from 0 to {}", text, UINT64_MAX);
  };
  return {check, ""};
}

/// One of a few words: refuses any other with the list of them.
template <class Value>
CLI::Option* add_choice(CLI::App& verb, const std::string& name, Value& value,
                        const names<Value>& choices, const std::string& help,
                        const std::string& shown) {
  const auto take = [&value, &choices](const std::string& word) {
    const auto found = choices.find(word);
    if (found == choices.end()) {
      std::string known;
      for (const auto& [choice, meaning] : choices) known += (known.empty() ? "" : ", ") + choice;
      throw CLI::ValidationError(fmt::format("'{}' is none of {}", word, known));
    }
    value = found->second;
  };
  return verb.add_option_function<std::string>(name, take, help)->type_name(shown);
}

constexpr const char* decode_footer =
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
order: what came so far is written.

Examples:
  g4-dump decode walk.bin -o walk.csv
  g4-dump decode walk.bin --format jsonl --scans --valid
  g4-dump sim --seconds 60 | g4-dump decode --format text --scans
  stty -F /dev/ttyUSB0 230400 raw -echo && g4-dump decode /dev/ttyUSB0 --format text
  tail -c +1 -f growing.bin | g4-dump decode -

Exit codes: 0 well, 2 wrong command line, 10 bad file or no packet in it, 130 after ^C.)";

constexpr const char* sim_footer =
    R"(The same options give the same bytes on every computer. The bytes begin with the answer to the
command that starts scanning; whole packets follow, all that were complete before N seconds.
--truth: index, time_ns, scan, first_level_deg, bearing_deg (where the target stands), range_mm
(of the target, exact; 0: there is none), raw (as sent, in quarters of a millimetre).

--link: a whole device that answers commands, on a pseudo-terminal that PATH leads to, instead.

Examples:
  g4-dump sim --seconds 60 --seed 7 -o room.bin --truth room.csv
  g4-dump sim --seconds 5 --noise-mm 8 --dropout 0.02 | g4-dump decode --format text
  g4-dump sim --link /tmp/lidar --log
  g4-dump sim --link /tmp/front --link /tmp/rear --fault unplug@5s+2s --fault 'flip*0.01%'

Exit codes: 0 well, 2 wrong command line, 10 a file that cannot be read or written, 130 after ^C.)";

CLI::App* add_decode(CLI::App& app, decode_options& options) {
  CLI::App* const verb =
      app.add_subcommand("decode", "Raw bytes from the port to points")->group("Verbs");
  verb->footer(decode_footer);
  verb->add_option("FILE", options.input,
                   "Bytes as they came from the port; - or nothing: standard input")
      ->type_name("");
  verb->add_option("-o,--output", options.output, "Where to write; - or nothing: standard output")
      ->type_name("OUT");
  add_choice(*verb, "-f,--format", options.style.format, text_formats,
             "How to write (csv); text is for people", "csv|jsonl|text");
  verb->add_flag("--scans", options.style.scans, "A record for each revolution, not each point");
  verb->add_flag("--valid", options.style.valid_only,
                 "Leave out the points from which nothing came back");
  verb->add_option("--rate", options.style.rate_hz,
                   "Samples a second, from which time_ns is counted (9000)")
      ->type_name("HZ")
      ->check(within(std::uint32_t{1}, std::uint32_t{1'000'000}));
  add_choice(*verb, "--stats", options.stats, stats_formats,
             "The counts at the end, on standard error (words)", "words|json");
  return verb;
}

/// The options that make it serve ptys, and those that then mean nothing.
void add_served(CLI::App& verb, sim_options& options, const std::vector<CLI::Option*>& not_then) {
  // Each takes one value, and may be given again.
  const auto add = [&verb](const std::string& name, std::vector<std::string>& values,
                           const std::string& help, const std::string& shown) {
    return verb.add_option(name, values, help)
        ->type_name(shown)
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->group("A device on a pseudo-terminal, in real time");
  };
  CLI::Option* const link =
      add("--link", options.links, "Serve a device here, until ^C; again for one more", "PATH");
  for (CLI::Option* const other : not_then) link->excludes(other);
  add("--serial", options.serials, "Of the devices, in turn: 16 digits each", "DIGITS")
      ->needs(link);
  add("--fault", options.faults, "KIND[=AMOUNT][*RATE][@BEGIN[+DURATION]]; see docs/sim.md",
      "FAULT")
      ->needs(link);
  verb.add_flag("--log", options.log, "What they are asked, on standard error")
      ->group("A device on a pseudo-terminal, in real time")
      ->needs(link);
}

CLI::App* add_sim(CLI::App& app, sim_options& options) {
  CLI::App* const verb =
      app.add_subcommand("sim", "The bytes that a G4 in a world of walls would send")
          ->group("Verbs");
  verb->footer(sim_footer);
  g4lidar::sim::scanner_options& scanner = options.scanner;
  CLI::Option* const seconds =
      verb->add_option("--seconds", options.seconds, "How long it scans (10)")
          ->type_name("N")
          ->check(within(0.0, 1e9));
  verb->add_option("--seed", scanner.seed, "Of all that is random (1)")
      ->type_name("S")
      ->check(whole_number());
  CLI::Option* const output = verb->add_option("-o,--output", options.output,
                                               "Where to write; - or nothing: standard output")
                                  ->type_name("FILE");
  CLI::Option* const truth =
      verb->add_option("--truth", options.truth, "What each sample truly was, as csv")
          ->type_name("FILE");
  verb->add_option("--world", options.world, "The walls (a flat of a few rooms); see docs/sim.md")
      ->type_name("FILE");
  verb->add_option_function<double>(
          "--frequency",
          [&scanner](double hz) {
            scanner.scan_frequency_chz = static_cast<std::uint16_t>(hz * 100.0 + 0.5);
          },
          "Revolutions a second, 5 to 12 (7)")
      ->type_name("HZ")
      ->check(within(5.0, 12.0));
  add_choice(*verb, "--rate", scanner.ranging, ranging_frequencies, "Samples a second (9000)",
             "4000|8000|9000");
  verb->add_option("--samples", scanner.samples_per_packet, "In a packet, 1 to 80 (40)")
      ->type_name("N");
  verb->add_option("--start-deg", scanner.start_deg, "The angle of the first sample (random)")
      ->type_name("DEG");
  verb->add_option("--index-deg", scanner.index_deg, "Where a revolution starts (0)")
      ->type_name("DEG");
  verb->add_option("--noise-mm", scanner.noise_mm, "Standard deviation of each range (0)")
      ->type_name("MM");
  verb->add_option("--noise-ratio", scanner.noise_ratio, "And what each mm of range adds to it (0)")
      ->type_name("RATIO");
  verb->add_option("--dropout", scanner.dropout_ratio,
                   "How many of all samples see nothing for no reason, 0 to 1 (0)")
      ->type_name("RATIO");
  verb->add_flag_function(
      "--no-reported-frequency", [&scanner](std::int64_t) { scanner.reports_frequency = false; },
      "Packets do not tell the scan frequency");
  add_served(*verb, options, {seconds, output, truth});
  return verb;
}

/// What is wrong with the command line, without a full stop.
std::string problem_with(const CLI::App& app, const CLI::ParseError& error) {
  if (app.get_subcommands().empty()) {
    std::string verbs;
    for (const CLI::App* const verb : app.get_subcommands([](const CLI::App*) { return true; })) {
      verbs += (verbs.empty() ? "" : " or ") + verb->get_name();
    }
    const std::vector<std::string> rest = app.remaining();
    if (rest.empty()) return "say what to do: " + verbs;
    const bool is_option = rest.front().front() == '-';
    return fmt::format("{} is no {}; say what to do: {}", in_quotes(rest.front()),
                       is_option ? "option" : "verb", verbs);
  }
  const std::vector<std::string> rest = app.remaining(true);
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr && !rest.empty()) {
    const bool is_option = rest.front().front() == '-';
    return in_quotes(rest.front()) + (is_option ? " is no option" : " is one argument too many");
  }
  std::string words = error.what();
  if (!words.empty() && words.back() == '.') words.pop_back();
  return words;
}

int explain(const CLI::App& app, const CLI::ParseError& error) {
  std::string verb;
  for (const CLI::App* const chosen : app.get_subcommands()) verb = " " + chosen->get_name();
  say(fmt::format("g4-dump: {}. See: g4-dump{} --help\n", problem_with(app, error), verb));
  return static_cast<int>(exit_code::usage);
}

}  // namespace

command read_command_line(int argc, const char* const* argv) {
  decode_options decode;
  sim_options sim;
  CLI::App app("The console tool for the YDLIDAR G4: points from its bytes", "g4-dump");
  app.set_version_flag("--version", fmt::format("g4-dump {}.{}.{}", G4LIDAR_VERSION_MAJOR,
                                                G4LIDAR_VERSION_MINOR, G4LIDAR_VERSION_PATCH));
  app.require_subcommand(1);
  app.fallthrough();
  app.footer(
      "\nData goes to standard output, words to standard error.\n"
      "More about a verb: g4-dump VERB --help");
  app.get_formatter()->label("SUBCOMMAND", "VERB");
  app.get_formatter()->column_width(36);
  const CLI::App* const decode_verb = add_decode(app, decode);
  const CLI::App* const sim_verb = add_sim(app, sim);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& wanted) {  // --help, --version
    return nothing_to_do{app.exit(wanted)};
  } catch (const CLI::ParseError& error) {
    return nothing_to_do{explain(app, error)};
  }
  if (decode_verb->parsed()) return decode;
  if (sim_verb->parsed()) return sim;
  return nothing_to_do{static_cast<int>(exit_code::usage)};
}

}  // namespace g4_dump
