// SPDX-License-Identifier: MIT
// The verb info: the information and settings of a device, or of a recording.
#include <fmt/format.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/exit_code.hpp"
#include "cli/setting_words.hpp"
#include "g4lidar/core/request.hpp"
#include "g4lidar/lidar_options.hpp"
#include "g4lidar/recording/reader.hpp"
#include "g4lidar/transport/source.hpp"
#include "io/command_source.hpp"
#include "io/interrupt.hpp"
#include "io/output.hpp"
#include "verbs/dump_verbs.hpp"

namespace g4_tool {
namespace {

using nlohmann::ordered_json;

struct device_facts {
  std::string source;
  std::optional<device_information> information{};
  std::vector<maybe_answer> settings{all_settings().size()};  ///< In the order of all_settings().
  /// The model, and the others that send the same bytes; empty: not known.
  std::vector<const g4lidar::model*> candidates{};
  std::string_view known_by{};                 ///< The model.
  std::string contradictions{};                ///< See contradictions_of().
  std::string_view why_unknown = "no answer";  ///< For settings that a lidar can be asked for.
};

device_facts facts_of_recording(const common_options& options) {
  auto opened = connector_for(options_for(options, {}));
  if (interrupt() != 0) throw interrupted();
  const auto from = value_of(std::move(opened));
  recognition found = from->traits().recognised;
  device_facts facts{.source = options.source, .why_unknown = "not recorded"};
  facts.known_by = name_of(found.by);
  facts.candidates.assign(found.candidates.begin(), found.candidates.end());
  if (facts.candidates.empty()) facts.candidates = {found.model};
  const recorded_device known = replay::reader_of(*from)->device().value_or(recorded_device{});
  const std::uint8_t number = known.information.model;
  if (number != 0 && !g4lidar::detail::may_report(*found.model, number)) found.number = number;
  facts.contradictions = contradictions_of(found);
  report_contradictions(facts.contradictions);
  if (number != 0) facts.information = known.information;
  facts.settings = {known.sample_rate, known.frequency, known.motor,
                    known.constant,    known.idle,      known.protection};
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
  if (options.expected.listen_only) facts.why_unknown = "only listened to";
  facts.candidates.assign(source.candidates().begin(), source.candidates().end());
  recognition found = lidar.recognition();
  found.has_shown_samples = true;  // nothing more is awaited
  facts.known_by = name_of(found.by);
  facts.contradictions = contradictions_of(found);
  report_contradictions(facts.contradictions);
  for (std::size_t i = 0; i < facts.settings.size(); ++i) {
    facts.settings[i] = read_setting(lidar, all_settings()[i]);
  }
  return facts;
}

device_facts facts_of(const common_options& options) {
  if (kind_of_source(options.source) != source_kind::recording) return facts_of_device(options);
  refuse_zero_angle(options, "info prints what was recorded");
  return facts_of_recording(options);
}

/// The value as text, or why it is unknown.
std::string words_for(const device_facts& facts, std::size_t index) {
  std::string text = text_of(facts.settings[index]);
  if (facts.settings[index]) return text;
  const setting_info& which = all_settings()[index];
  const g4lidar::model* const of = facts.candidates.empty() ? nullptr : facts.candidates.front();
  if (of != nullptr && !has_request(*of, which.query ? which.query->what : which.change)) {
    return fmt::format("{} ({} has no such setting)", text, of->name);
  }
  if (which.query) return fmt::format("{} ({})", text, facts.why_unknown);
  return fmt::format("{} ({} cannot be asked for it)", text,
                     of != nullptr ? fmt::format("{} {}", article_of(*of), of->name) : "a lidar");
}

/// Its name, and which others it may be.
std::string words_for(std::span<const g4lidar::model* const> candidates) {
  std::string text(candidates.front()->name);
  if (candidates.size() < 2) return text;
  return fmt::format("{} (or {}: name yours with --model)", text,
                     model_words(candidates.subspan(1)));
}

void write(const device_facts& facts, bool as_json, output& out) {
  ordered_json all{{"source", facts.source}};
  all.update(json_of(facts.information));
  if (!as_json && !facts.candidates.empty()) all["model"] = words_for(facts.candidates);
  if (as_json) all["lidar"] = json_of(facts.candidates);
  if (as_json && !facts.known_by.empty()) all["lidar"]["known_by"] = facts.known_by;
  if (as_json) all["lidar"]["contradictions"] = facts.contradictions;
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
that set takes: sample_rate, frequency, direction, constant, idle, protection. What the model does
not have, or cannot be asked for, is unknown, with the reason. Of a G4 these are constant and
protection, and with old firmware direction.
Some models send the same bytes: then model also names the others, and --model decides.
With --json, model is a number (a G4 is 5), lidar has the word of the model and those of all
candidates, sample_rate is in Hz, on is true, unknown is null.

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
       .examples = {{"g4-dump info", "Information about the only lidar"},
                    {"g4-dump info /dev/ttyUSB0 --json", "The same of one port, as JSON"}}},
      info, true);
}

}  // namespace g4_tool
