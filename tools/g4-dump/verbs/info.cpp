// SPDX-License-Identifier: MIT
// The verb info: the information and settings of a device, or of a recording.
#include <fmt/format.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/exit_code.hpp"
#include "cli/settings.hpp"
#include "g4lidar/core/session/model_requests.hpp"
#include "g4lidar/recording/reader.hpp"
#include "io/command_source.hpp"
#include "io/input.hpp"
#include "io/output.hpp"
#include "verbs/verbs.hpp"

namespace g4_tool {
namespace {

using nlohmann::ordered_json;

struct device_facts {
  std::string source;
  std::optional<device_information> information{};
  std::vector<maybe_answer> settings{all_settings().size()};  ///< In the order of all_settings().
  const g4lidar::model* model = nullptr;       ///< That a recording states, or that was named.
  std::string_view why_unknown = "no answer";  ///< For settings that a G4 can be asked for.
};

device_facts facts_of_recording(const std::string& source) {
  const auto reader = open_recording(path_of_source(source));
  device_facts facts{.source = source, .why_unknown = "not recorded"};
  const auto& known = reader.device();
  if (!known) return facts;
  if (known->information.model != 0) facts.information = known->information;
  facts.settings = {known->sample_rate, known->frequency, known->motor,
                    known->constant,    known->idle,      known->protection};
  return facts;
}

/// A one-way lidar identifies itself in a whole revolution, if it does.
void listen(g4lidar::lidar& lidar) {
  constexpr int revolutions = 3;
  value_of(lidar.start());
  for (int i = 0; i < revolutions && !lidar.information().is_known(); ++i) {
    if (!lidar.wait_scan(std::chrono::seconds(2))) break;
  }
  value_of(lidar.stop());
}

device_facts facts_of_device(const common_options& options) {
  command_source source(options, task::asking);
  g4lidar::lidar& lidar = source.lidar();
  device_facts facts{.source = std::string(lidar.name())};
  if (!lidar.information().is_known()) listen(lidar);
  if (lidar.information().is_known()) facts.information = lidar.information();
  const bool is_unnamed =
      kind_of_source(options.source) == source_kind::device && options.expected.model == nullptr;
  if (!is_unnamed) {
    facts.model = model_of(options);
  } else if (facts.information) {
    facts.model = model_with_id(facts.information->model, link_kind::two_way);
  }
  for (std::size_t i = 0; i < facts.settings.size(); ++i) {
    facts.settings[i] = read_setting(lidar, all_settings()[i]);
  }
  return facts;
}

device_facts facts_of(const common_options& options) {
  if (kind_of_source(options.source) != source_kind::recording) return facts_of_device(options);
  device_facts facts = facts_of_recording(options.source);
  facts.model = model_of(options);
  return facts;
}

/// The value as text, or why it is unknown.
std::string words_for(const device_facts& facts, std::size_t index) {
  std::string text = text_of(facts.settings[index]);
  if (facts.settings[index]) return text;
  const setting_info& which = all_settings()[index];
  if (facts.model != nullptr && !has_request(*facts.model, which.change)) {
    return fmt::format("{} ({} has no such setting)", text, facts.model->name);
  }
  const bool can_ask = which.query.has_value();
  return fmt::format("{} ({})", text, can_ask ? facts.why_unknown : "a G4 cannot be asked for it");
}

void write(const device_facts& facts, bool as_json, output& out) {
  ordered_json all{{"source", facts.source}};
  all.update(json_of(facts.information));
  if (!as_json && facts.information && facts.information->model == model_g4) all["model"] = "G4";
  if (!as_json && facts.model != nullptr) all["model"] = facts.model->name;
  for (std::size_t i = 0; i < facts.settings.size(); ++i) {
    ordered_json& value = all[std::string(all_settings()[i].name)];
    value = as_json ? json_of(facts.settings[i]) : ordered_json(words_for(facts, i));
  }
  write_object(out, all, 12, as_json);
}

exit_code info(const common_options& options) {
  output out(options.output);
  write(facts_of(options), options.json, out);
  out.commit();
  return exit_code::ok;
}

constexpr const char* info_details =
    R"(A line for each of: source, model, serial, firmware, hardware, and the settings by the names
that set takes: sample_rate, frequency, direction, constant, idle, protection. A G4 cannot be asked
for constant and protection, and old firmware does not answer for direction: these are unknown,
with the reason.
With --json, model is a number (a G4 is 5), sample_rate is in Hz, on is true, unknown is null.

No setting is changed, but a device that is scanning is stopped first; that is reported.)";

}  // namespace

void write_facts(const common_options& options, output& out) {
  write(facts_of(options), false, out);
}

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
