// SPDX-License-Identifier: MIT
// The verb doctor: prints each stage, as text or JSON, when it is done.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <ranges>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "cli/common_options.hpp"
#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "io/command_source.hpp"
#include "io/interrupt.hpp"
#include "io/output.hpp"
#include "io/source_word.hpp"
#include "verbs/dump_verbs.hpp"
#include "verbs/problem_report.hpp"

namespace g4_tool {
namespace {

constexpr std::size_t text_indent = 15;

struct doctor_options : common_options {
  std::string report;  ///< The text of a report; empty: none.
};

std::string list_of(std::span<const diagnosis> all) {
  const auto name = [](diagnosis each) { return describe(each).name; };
  return fmt::format("{}", fmt::join(all | std::views::transform(name), ", "));
}

/// "FAIL" in red, on a terminal.
std::string flag_of(stage_verdict how, bool colored) {
  constexpr std::array<std::string_view, 4> words{"ok", "skipped", "warn", "FAIL"};
  constexpr std::array<int, 4> colors{32, 2, 33, 31};
  const auto at = static_cast<std::size_t>(how);
  if (!colored) return fmt::format("{:<4}", words[at]);
  return fmt::format("\033[{}m{:<4}\033[0m", colors[at], words[at]);
}

std::string text_of_report(const stage_report& report, bool colored) {
  std::vector<std::string> lines;
  for (const diagnosis what : report.diagnoses) {
    const diagnosis_info info = report.explain(what);
    lines.push_back(fmt::format("{}: {}", info.name, info.cause));
    if (!info.alternatives.empty()) lines.push_back("or: " + list_of(info.alternatives));
    lines.push_back("try: " + in_tool_words(info.advice));
  }
  std::string measured;
  for (const evidence& each : report.measurements) {
    measured.append(measured.empty() ? "" : ", ");
    measured.append(each.name).append(" ").append(printable(each.text()));
  }
  if (!measured.empty()) lines.push_back((lines.empty() ? "" : "measured: ") + measured);
  if (!report.remark.empty() || lines.empty()) lines.push_back(printable(report.remark));
  std::string text =
      fmt::format("{:<13}{} ", name_of(report.stage), flag_of(report.outcome, colored));
  for (const std::string& line : lines) {
    const bool is_first = &line == lines.data();
    if (!is_first) text.append(text_indent, ' ');
    text += wrapped(line, is_first ? text_indent + 3 : text_indent, text_indent) + "\n";
  }
  return text;
}

nlohmann::ordered_json json_of_report(const stage_report& report) {
  using nlohmann::ordered_json;
  ordered_json line{{"stage", name_of(report.stage)},
                    {"verdict", name_of(report.outcome)},
                    {"diagnoses", ordered_json::array()},
                    {"evidence", ordered_json::object()}};
  for (const diagnosis what : report.diagnoses) {
    const diagnosis_info info = report.explain(what);
    ordered_json others = ordered_json::array();
    for (const diagnosis other : info.alternatives) others.push_back(describe(other).name);
    line["diagnoses"].push_back({{"name", info.name},
                                 {"cause", info.cause},
                                 {"or", others},
                                 {"try", in_tool_words(info.advice)}});
  }
  for (const evidence& each : report.measurements) {
    std::visit([&](const auto& value) { line["evidence"][each.name] = value; }, each.value);
  }
  if (!report.remark.empty()) line["remark"] = report.remark;
  return line;
}

/// For all other diagnoses the exit code is unhealthy.
using failure_code = std::pair<diagnosis, exit_code>;
constexpr std::array<failure_code, 18> failure_codes{{
    {diagnosis::no_port, exit_code::no_device},
    {diagnosis::several_ports, exit_code::no_device},
    {diagnosis::not_serial, exit_code::no_device},
    {diagnosis::cannot_connect, exit_code::no_device},
    {diagnosis::system, exit_code::no_device},
    {diagnosis::bad_file, exit_code::bad_file},
    {diagnosis::permission, exit_code::permission},
    {diagnosis::busy, exit_code::busy},
    {diagnosis::interference, exit_code::busy},
    {diagnosis::bad_baud_rate, exit_code::silent},
    {diagnosis::unknown_bytes, exit_code::silent},
    {diagnosis::wrong_baud_rate, exit_code::silent},
    {diagnosis::silent, exit_code::silent},
    {diagnosis::no_lidar, exit_code::not_a_g4},
    {diagnosis::other_device, exit_code::not_a_g4},
    {diagnosis::one_way_lidar, exit_code::not_a_g4},
    {diagnosis::unplugged, exit_code::lost},
    {diagnosis::stalls, exit_code::lost},
}};

/// The exit code of the first stage that failed.
exit_code exit_code_of(std::span<const stage_report> stages) noexcept {
  for (const stage_report& each : stages) {
    for (const diagnosis what : each.diagnoses) {
      if (std::min(each.outcome, describe(what).severity) != stage_verdict::fail) continue;
      const auto* const at = std::ranges::find(failure_codes, what, &failure_code::first);
      return at == failure_codes.end() ? exit_code::unhealthy : at->second;
    }
  }
  return exit_code::ok;
}

/// The last line of the text output. `named`: as which the bytes were read, if that was stated or follows from them.
std::string summary_of(std::span<const stage_report> stages, const g4lidar::model* named) {
  std::vector<diagnosis> found;
  for (const stage_report& each : stages) {
    found.insert(found.end(), each.diagnoses.begin(), each.diagnoses.end());
  }
  if (!found.empty()) return "found: " + list_of(found) + "\n";
  const bool is_known = std::ranges::any_of(stages, [](const stage_report& each) {
    return each.stage == diagnostic_stage::identity && each.outcome == stage_verdict::ok;
  });
  if (is_known) return "healthy: nothing is wrong\n";
  if (named == nullptr) return "no fault found, but these bytes do not name their model\n";
  return fmt::format("no fault found; the bytes were read as {}\n", named->name);
}

int examine(const doctor_options& options) {
  output out(options.output);
  if (options.source == "-") {
    throw bad_value("doctor examines a device or a file, not standard input");
  }
  refuse_options_of_others(options);
  diagnostic_options how;
  how.baud = options.expected.baud;
  how.insist_on_model = options.expected.insist_on_model;
  how.listen_only = options.expected.listen_only;
  how.probe_all_ports = options.expected.probe_all_ports;
  const source_kind kind = kind_of_source(options.source);
  std::optional<recognised_model> seen;
  // What cannot be read as the named model is examined all the same.
  const bool is_named = kind == source_kind::raw_bytes && options.expected.model != nullptr;
  const g4lidar::model* const named = kind != source_kind::simulated && !is_named
                                          ? model_of(options, &seen)
                                          : options.expected.model;
  // A recording states its model itself, and what contradicts it.
  how.model = kind != source_kind::recording ? named : options.expected.model;
  if (seen) report_model(*seen->which, seen->is_usual());
  if (options.duration.count() > 0) how.measuring_time = options.duration;
  how.directions = directions_of(options);
  how.is_cancelled = [] { return interrupt() != 0; };
  std::optional<problem_report> report;
  if (!options.report.empty()) report.emplace(options, options.report);
  how.on_stage = [&, colored = wants_color(out.descriptor())](const stage_report& stage) {
    out.write(options.json ? json_line(json_of_report(stage)) : text_of_report(stage, colored));
    out.flush();
    if (report) report->add(text_of_report(stage, false));
  };
  how.on_activity = [&](diagnostic_activity what) {
    if (options.json) return;
    if (what == diagnostic_activity::spinning_up) {
      out.write("spinning up: the lidar has started and sends nothing yet\n");
    } else if (what == diagnostic_activity::searching) {
      out.write("searching: which lidar is there, and at which baud rate\n");
    }
    out.flush();
  };
  const std::vector<stage_report> stages = diagnose(options.source, how);
  const bool is_guess = seen && seen->basis != g4lidar::recognised_by::number;
  const std::string summary =
      interrupt() == 0 ? summary_of(stages, is_guess ? nullptr : named) : "interrupted\n";
  if (!options.json && interrupt() == 0) out.write(summary);
  out.commit();
  if (report) {
    report->add(summary);
    report->finish();
  }
  return interrupt() != 0 ? 128 + interrupt() : static_cast<int>(exit_code_of(stages));
}

constexpr const char* doctor_details =
    R"(It examines port, permission, holder, baud rate, answers, identity, health, motor, stream, rate,
loss, returns and USB latency. It reports for each what was measured; where something is wrong also the
likely cause and what to try. For a healthy lidar it takes about 8 seconds. No setting is changed,
and the motor is stopped at the end, if it can be. The model and the baud rate are found, or are
those of --model and --baud: then another one is reported. Models that answer nothing are listened
to; what needs answers does not apply to them. A recording or a file of raw bytes is examined as far as its
bytes allow; stages that need a device are skipped. The exit code is that of the first stage that
failed; a stage that only warns leaves it at 0.

--report FILE writes the text FILE with what a report of a problem needs: versions, system, ports
and who has them open, diagnosis, settings. Ten seconds of the lidar are recorded beside it: in
report.mcap for report.txt. A file is not recorded again: it is the second file of the report. The
text states what is in both. In the place of what cannot be found out, as without a lidar, is the
reason.)";

}  // namespace

verb make_doctor_verb() {
  const auto options = std::make_shared<doctor_options>();
  return {
      .name = "doctor",
      .summary = "What is wrong with a lidar, its port or a file, and what to try",
      .arguments = {source_argument(*options)},
      .options = joined(
          output_rows(*options), json_row(*options, "A JSON object for each stage, a line each"),
          duration_row(*options, "Listen to the scan for so long (5s)"),
          rows_of("Device", {"baud"}, options->expected), row_of("model", options->expected),
          rows_of("Device", {"listen_only"}, options->expected),
          rows_of("Device", {"probe_all_ports"}, options->expected), direction_rows(*options),
          in_group(
              "Filters",
              {frame_row("--frame",
                         "Of --fov and --ignore; vendor: clockwise from 0 of the lidar (vendor)",
                         options->frame)}),
          in_group("Report of a problem",
                   {text_row("--report", "FILE",
                             "Write a text, and a recording beside it, to attach to a report",
                             options->report, completion::output)})),
      .details = doctor_details,
      .examples = {{"g4-dump doctor", "Examine the only lidar"},
                   {"g4-dump doctor --json -d 30s /dev/ttyUSB0",
                    "Listen to one port for 30 s, as JSON"},
                   {"g4-dump doctor walk.mcap", "Examine a recording"},
                   {"g4-dump doctor --report report.txt",
                    "Write report.txt and report.mcap, to attach to a report of a problem"},
                   {"g4-dump doctor 'sim:?fault=flip'", "A simulated G4 on a bad cable"},
                   {"g4-dump doctor 'sim:?model=x4&motor_has_power=false'",
                    "A simulated X4 without its second plug"}},
      .run = [options] { return examine(*options); }};
}

}  // namespace g4_tool
