// SPDX-License-Identifier: MIT
// The verb set: changes settings, and prints each before and after.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "cli/setting_words.hpp"
#include "g4lidar/core/request.hpp"
#include "g4lidar/options/lidar_parameters.hpp"
#include "g4lidar/transport/source.hpp"
#include "io/command_source.hpp"
#include "io/interrupt.hpp"
#include "io/output.hpp"
#include "verbs/dump_verbs.hpp"

namespace g4_tool {
namespace {

struct set_options : common_options {
  std::vector<std::string> changes;  ///< NAME=VALUE.
};

void add_change(set_options& options, const std::string& word) {
  if (!is_change(word))
    throw bad_value(fmt::format("'{}' is not NAME=VALUE such as sample_rate=9k", word));
  options.changes.push_back(word);
}

/// With the limits of the model, if it is known before the lidar is opened.
std::vector<setting_change> changes_of(const set_options& options) {
  const g4lidar::model* const named = options.expected.model;
  const g4lidar::model* const which =
      g4lidar::model_of_source({.device = options.source, .model = named}).value_or(named);
  std::vector<setting_change> all;
  for (const std::string& word : options.changes) {
    const setting_change added = change_of(word, which);
    if (std::ranges::find(all, added.which, &setting_change::which) != all.end())
      throw bad_value(fmt::format("{} is given twice", added.which->name));
    all.push_back(added);
  }
  return all;
}

void write_row(output& out, std::string_view name, std::string_view before,
               std::string_view after) {
  out.write(fmt::format("{:<11} {:<8} {}\n", name, before, after));
}

/// Changes one setting. If that fails, writes the value that the device has and throws a failure.
void execute(g4lidar::lidar& lidar, const setting_change& wanted, output& out, bool json) {
  const maybe_answer before = read_setting(lidar, *wanted.which);
  const auto given = lidar.ask(change_to(wanted.value));
  if (!given && given.error().is_fatal()) throw failure(given.error());
  const maybe_answer after = given ? *given : read_setting(lidar, *wanted.which);
  if (json) {
    out.write(json_line({{"name", wanted.which->name},
                         {"before", json_of(before)},
                         {"wanted", json_of(wanted.value)},
                         {"after", json_of(after)}}));
  } else {
    write_row(out, wanted.which->name, text_of(before), text_of(after));
  }
  out.flush();
  if (!given) throw failure(given.error());
}

/// "has 5 to 12 Hz": what the model can have.
std::string possible_values(const g4lidar::model& model, const setting_info& setting) {
  const parameter_limits row = limits_of(*find_parameter(setting.name), &model);
  if (setting.type == setting_type::decimal)
    return fmt::format("has {} to {} Hz", row.range[0], row.range[1]);
  if (setting.type != setting_type::whole) return "cannot have it";
  return fmt::format("has {} samples per second", row.constraints);
}

/// Throws a bad_value if the lidar cannot have one of the values: then nothing is changed.
void check(const std::vector<setting_change>& changes, const g4lidar::model& model) {
  for (const setting_change& each : changes) {
    const request wanted = change_to(each.value);
    if (!has_request(model, wanted.what) || is_possible(wanted, model)) continue;
    throw bad_value(fmt::format("{}={}: {} {} {}", each.which->name, text_of(each.value),
                                article_of(model), model.name,
                                possible_values(model, *each.which)));
  }
}

/// Logs what the changes mean for the user.
void report_consequences(const std::vector<setting_change>& changes) {
  logger::info("The settings may be lost when the lidar restarts or has no power.\n");
  const answer protection(power_down_protection::on);
  if (std::ranges::find(changes, protection, &setting_change::value) != changes.end()) {
    logger::info(
        "With protection on, the lidar stops 3 s after the last keep-alive: dump, scan and record "
        "send them, start does not.\n");
  }
}

int set(const set_options& options) {
  if (options.changes.empty())
    throw bad_value("nothing to set; give NAME=VALUE such as sample_rate=9k");
  refuse_listening(options);
  const std::vector<setting_change> changes = changes_of(options);
  output out("-");
  command_source source(options, task::configuring);
  check(changes, *source.lidar().recognition().model);
  if (!options.json) write_row(out, "NAME", "BEFORE", "AFTER");
  for (const setting_change& each : changes) {
    if (interrupt() != 0) return 128 + interrupt();
    execute(source.lidar(), each, out, options.json);
  }
  out.commit();
  report_consequences(changes);
  return static_cast<int>(exit_code::ok);
}

constexpr const char* set_details =
    R"(
Nothing is changed if one of them is not valid. Each is read, set and read back: a line with
NAME, BEFORE and AFTER; with --json an object with name, before, wanted, after. A G4 cannot be
asked for constant and protection: BEFORE is unknown. If the device refuses a value, AFTER is the
value that it has, the settings that follow are not changed, and the exit code is 8.)";

std::string details() {
  std::string all = "Settings:\n";
  for (const setting_info& each : all_settings()) {
    all +=
        fmt::format("  {:<21} {}\n", fmt::format("{}={}", each.name, values_of(each)), each.text);
  }
  return all + set_details;
}

}  // namespace

verb make_set_verb() {
  const auto options = std::make_shared<set_options>();
  const auto take_change = [set = options.get()](const std::string& word) {
    add_change(*set, word);
  };
  option_row source = source_argument(*options);
  source.help = "The lidar (the only lidar)";
  source.take = [take_change, as_source = source.take](const std::string& word) {
    is_change(word) ? take_change(word) : as_source(word);
  };
  return {.name = "set",
          .summary = "Change settings; prints them before and after",
          .arguments = {source,
                        {"NAME=VALUE", "", "The settings to change", take_change,
                         completion::setting, true}},
          .options = joined(json_row(*options), device_rows(*options)),
          .details = details(),
          .examples = {{"g4-dump set sample_rate=9k frequency=10",
                        "9000 samples and 10 revolutions per second"},
                       {"g4-dump set /dev/ttyUSB0 protection=on", "Turn on power-down protection"},
                       {"g4-dump set sim: sample_rate=4k frequency=7.5 direction=ccw --json",
                        "Three settings of a simulated G4"}},
          .run = [options] { return set(*options); }};
}

}  // namespace g4_tool
