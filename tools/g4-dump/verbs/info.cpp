// SPDX-License-Identifier: MIT
// The verb info: what a device, or a recording of one, reports about itself and its settings.
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/exit_code.hpp"
#include "cli/settings.hpp"
#include "g4lidar/recording/reader.hpp"
#include "io/command_source.hpp"
#include "io/output.hpp"
#include "verbs/verbs.hpp"

namespace g4_tool {
namespace {

using nlohmann::ordered_json;

/// All that is known about a device.
struct device_facts {
  std::string source;
  std::optional<device_information> information{};
  std::vector<maybe_answer> settings{all_settings().size()};  ///< In their order.
};

device_facts facts_of_recording(const std::string& source) {
  const auto reader = value_of(recording_reader::open(path_of(source)));
  device_facts facts{.source = source};
  const auto& known = reader.device();
  if (!known) return facts;
  if (known->information.model != 0) facts.information = known->information;
  facts.settings = {known->ranging,  known->frequency, known->motor,
                    known->constant, known->idle,      known->protection};
  return facts;
}

device_facts facts_of_device(const common_options& options) {
  command_source source(options, task::asking);
  g4lidar::lidar& lidar = source.lidar();
  device_facts facts{.source = std::string(lidar.name()), .information = lidar.information()};
  for (std::size_t i = 0; i < facts.settings.size(); ++i) {
    facts.settings[i] = read_setting(lidar, all_settings()[i]);
  }
  return facts;
}

void write(const device_facts& facts, bool as_json, output& out) {
  ordered_json all{{"source", facts.source}};
  all.update(json_of(facts.information));
  if (!as_json && facts.information && facts.information->model == model_g4) all["model"] = "G4";
  for (std::size_t i = 0; i < facts.settings.size(); ++i) {
    ordered_json& value = all[std::string(all_settings()[i].name)];
    value = as_json ? json_of(facts.settings[i]) : ordered_json(text_of(facts.settings[i]));
  }
  write_object(out, all, 12, as_json);
}

exit_code info(const common_options& options) {
  const std::string& source = options.source;
  output out(options.output);
  const bool is_recording = kind_of(source) == source_kind::recording;
  const device_facts facts = is_recording ? facts_of_recording(source) : facts_of_device(options);
  write(facts, options.json, out);
  out.commit();
  return exit_code::ok;
}

constexpr const char* info_details =
    R"(A line for each of: source, model, serial, firmware, hardware, and the settings by the names
that set takes: sample_rate, freq, direction, constant, idle, protection. A G4 cannot be asked
for constant and protection, and old firmware does not answer for direction: these are unknown.
With --json, model is a number (a G4 is 5), sample_rate is in Hz, on is true, unknown is null.

No setting is changed, but a device that is scanning is stopped first; that is reported.)";

}  // namespace

verb make_info_verb() {
  return device_verb(
      {.name = "info",
       .summary = "Print device information and settings",
       .details = info_details,
       .examples = {{"g4-dump info", "Information about the only G4"},
                    {"g4-dump info /dev/ttyUSB0 --json", "The same of one port, as JSON"}}},
      info, true);
}

}  // namespace g4_tool
