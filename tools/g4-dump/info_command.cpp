// SPDX-License-Identifier: MIT
// The verbs info and health: what a device, or a recording of one, says of itself. They set nothing.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "exit_code.hpp"
#include "g4lidar/recording_reader.hpp"
#include "manners.hpp"
#include "output.hpp"
#include "settings.hpp"
#include "talk.hpp"
#include "verbs.hpp"

namespace g4_dump {
namespace {

using nlohmann::ordered_json;

struct talk_options {
  shared_options common = std::make_shared<common_options>();
  std::shared_ptr<bool> json = std::make_shared<bool>(false);
};

/// All that is to be told of a device.
struct device_facts {
  std::string source;
  std::optional<g4lidar::device_information> information;
  std::array<std::optional<g4lidar::answer>, all_settings.size()> settings;
};

template <class Value>
std::optional<g4lidar::answer> answer_of(const std::optional<Value>& value) {
  if (!value) return std::nullopt;
  return g4lidar::answer(*value);
}

device_facts facts_of_recording(const std::string& source) {
  std::string_view path = source;
  constexpr std::string_view file_prefix = "file:";
  if (path.starts_with(file_prefix)) path.remove_prefix(file_prefix.size());
  const auto reader = g4lidar::recording_reader::open(path);
  if (!reader) throw failure(reader.error());
  device_facts facts{.source = source, .information = {}, .settings = {}};
  const auto& known = reader->device();
  if (!known) return facts;
  if (known->information.model != 0) facts.information = known->information;
  facts.settings = {answer_of(known->ranging), answer_of(known->frequency),
                    answer_of(known->motor),   answer_of(known->constant),
                    answer_of(known->idle),    answer_of(known->protection)};
  return facts;
}

device_facts facts_of_device(const common_options& options) {
  talking_source source(options, g4lidar::task::asking);
  g4lidar::lidar& lidar = source.lidar();
  device_facts facts{
      .source = std::string(lidar.name()), .information = lidar.information(), .settings = {}};
  for (const setting each : all_settings) {
    facts.settings[static_cast<std::size_t>(each)] = read_setting(lidar, each);
  }
  return facts;
}

std::string version_of(const g4lidar::device_information& who) {
  return fmt::format("{}.{}", who.firmware_major, who.firmware_minor);
}

void write_text(const device_facts& facts, output& out) {
  const auto line = [&out](std::string_view name, std::string_view value) {
    out.write(fmt::format("{:<12}{}\n", name, value));
  };
  line("source", facts.source);
  if (const auto& who = facts.information) {
    const bool is_g4 = who->model == g4lidar::model_g4;
    line("model", is_g4 ? std::string("G4") : fmt::format("{}", who->model));
    line("serial", who->serial_number());
    line("firmware", version_of(*who));
    line("hardware", fmt::format("{}", who->hardware));
  } else {
    for (const char* const name : {"model", "serial", "firmware", "hardware"})
      line(name, "unknown");
  }
  for (const setting each : all_settings) {
    line(name_of(each), text_of(facts.settings[static_cast<std::size_t>(each)]));
  }
}

void write_json(const device_facts& facts, output& out) {
  ordered_json all;
  all["source"] = facts.source;
  const auto put = [&](const char* name, auto&& value_of) {
    all[name] = facts.information ? ordered_json(value_of(*facts.information)) : ordered_json();
  };
  using information = g4lidar::device_information;
  put("model", [](const information& who) { return who.model; });
  put("serial", [](const information& who) { return std::string(who.serial_number()); });
  put("firmware", [](const information& who) { return version_of(who); });
  put("hardware", [](const information& who) { return who.hardware; });
  for (const setting each : all_settings) {
    all[std::string(name_of(each))] = json_of(facts.settings[static_cast<std::size_t>(each)]);
  }
  write_line(out, all);
}

int info(const talk_options& options) {
  const std::string& source = options.common->source;
  output out(options.common->output);
  const bool is_recording = kind_of(source) == source_kind::recording;
  const device_facts facts =
      is_recording ? facts_of_recording(source) : facts_of_device(*options.common);
  *options.json ? write_json(facts, out) : write_text(facts, out);
  out.commit();
  return static_cast<int>(exit_code::ok);
}

const char* word_for(g4lidar::health_status status) noexcept {
  constexpr std::array<const char*, 3> words{"ok", "warning", "error"};
  return words[static_cast<std::size_t>(status)];
}

int health(const talk_options& options) {
  output out(options.common->output);
  talking_source source(*options.common, g4lidar::task::asking);
  const auto given = source.lidar().ask_for<g4lidar::health>(g4lidar::requests::health());
  if (!given) throw failure(given.error());
  if (*options.json) {
    ordered_json all;
    all["source"] = source.lidar().name();
    all["status"] = word_for(given->status);
    all["error_code"] = given->error_code;
    write_line(out, all);
  } else {
    out.write(fmt::format("{:<12}{}\n{:<12}{}\n", "status", word_for(given->status), "error_code",
                          given->error_code));
  }
  out.commit();
  const bool is_ill = given->status == g4lidar::health_status::error;
  return static_cast<int>(is_ill ? exit_code::unhealthy : exit_code::ok);
}

constexpr const char* info_details =
    R"(A line for each: source, model, serial, firmware, hardware, and the settings by the names that
set takes: rate (4k, 8k, 9k), freq (Hz), direction (cw, ccw), constant, idle, protection (on, off).
A G4 can be asked for neither constant nor protection, and old firmware does not tell direction:
these are unknown. Of a recording: what it knows. With --json model is a number (a G4 is 5), rate is
in Hz, on is true, unknown is null.

Nothing is set. But a device that is found scanning is stopped, since it cannot be asked else; that
is told.)";

constexpr const char* health_details =
    R"(Two lines, status (ok, warning, error) and error_code; what the bits of the code mean is not known.
Exits with 8 where the status is error. A device that is found scanning is stopped; that is told.)";

verb make(const char* name, int (*run)(const talk_options&)) {
  const talk_options options;
  verb made;
  made.name = name;
  made.arguments.push_back(source_argument(options.common));
  made.options.push_back(json_row(options.json));
  made.options.push_back(output_row(options.common));
  append(made.options, device_rows(options.common));
  made.exits = talk_exits();
  made.run = [options, run] { return run(options); };
  return made;
}

}  // namespace

verb make_info_verb() {
  verb made = make("info", info);
  made.summary = "Who it is, and all its settings";
  made.details = info_details;
  made.examples = {"g4-dump info", "g4-dump info /dev/ttyUSB0 --json", "g4-dump info sim:"};
  return made;
}

verb make_health_verb() {
  verb made = make("health", health);
  made.summary = "How it says it is";
  made.details = health_details;
  made.examples = {"g4-dump health", "g4-dump health --json",
                   "g4-dump health 'sim:?fault=health=warning'"};
  return made;
}

}  // namespace g4_dump
