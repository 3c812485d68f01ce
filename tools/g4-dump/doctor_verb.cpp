// SPDX-License-Identifier: MIT
// The verb doctor: the stages in words or as JSON, each as it is done.
#include <fmt/format.h>

#include <cctype>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "common_options.hpp"
#include "doctor_exam.hpp"
#include "doctor_port.hpp"
#include "doctor_words.hpp"
#include "g4lidar/serial_port.hpp"
#include "interrupt.hpp"
#include "manners.hpp"
#include "output.hpp"
#include "source.hpp"
#include "verbs.hpp"

namespace g4_dump {
namespace {

struct doctor_options {
  shared_options common = std::make_shared<common_options>();
  bool json = false;
};

constexpr std::size_t text_width = 98;
constexpr std::size_t text_indent = 15;

/// Words in lines, with the room of the stage's name before all but the first.
std::string wrapped(std::string_view words, std::size_t column) {
  std::string text;
  while (!words.empty()) {
    const std::size_t end = std::min(words.find(' '), words.size());
    if (column + 1 + end > text_width && column > text_indent) {
      text.append("\n").append(text_indent, ' ');
      column = text_indent;
    } else if (!text.empty()) {
      text += ' ';
      ++column;
    }
    text.append(words.substr(0, end));
    column += end;
    words.remove_prefix(std::min(end + 1, words.size()));
  }
  return text;
}

std::string text_of(const fact& measured) {
  if (const auto* number = std::get_if<std::int64_t>(&measured.value)) {
    return fmt::format("{} {}", measured.name, *number);
  }
  if (const auto* number = std::get_if<double>(&measured.value)) {
    return fmt::format("{} {:.4g}", measured.name, *number);
  }
  return fmt::format("{} {}", measured.name, std::get<std::string>(measured.value));
}

std::string names_of(std::span<const diagnosis> all) {
  std::string names;
  for (const diagnosis each : all) {
    names.append(names.empty() ? "" : ", ").append(words_of(each).name);
  }
  return names;
}

/// "FAIL" in red, on a terminal.
std::string mark_of(verdict how, bool colored) {
  constexpr std::array<std::string_view, 4> words{"ok", "skipped", "warn", "FAIL"};
  constexpr std::array<int, 4> colors{32, 2, 33, 31};
  const auto at = static_cast<std::size_t>(how);
  if (!colored) return fmt::format("{:<4}", words[at]);
  return fmt::format("\033[{}m{:<4}\033[0m", colors[at], words[at]);
}

std::string text_of(const stage_report& report, bool colored) {
  const std::string margin(text_indent, ' ');
  std::string measured;
  for (const fact& each : report.facts) {
    measured.append(measured.empty() ? "" : ", ").append(text_of(each));
  }
  std::string text = fmt::format("{:<13}{} ", name_of(report.where), mark_of(report.how, colored));
  if (report.found.empty()) {
    if (measured.empty()) measured = std::exchange(measured, report.remark);
    text += wrapped(measured.empty() ? report.remark : measured, text_indent + 3) + "\n";
    return text;
  }
  bool is_first = true;
  for (const diagnosis what : report.found) {
    const diagnosis_words& words = words_of(what);
    const std::string line = fmt::format("{}: {}", words.name, words.cause);
    text += (is_first ? "" : margin) + wrapped(line, text_indent + 3) + "\n";
    is_first = false;
    if (!words.or_else.empty()) {
      text += margin + wrapped("or: " + names_of(words.or_else), text_indent) + "\n";
    }
    text += margin + wrapped(fmt::format("try: {}", words.advice), text_indent) + "\n";
  }
  if (!measured.empty()) text += margin + wrapped("measured: " + measured, text_indent) + "\n";
  if (!report.remark.empty()) text += margin + wrapped(report.remark, text_indent) + "\n";
  return text;
}

std::string json_of(const stage_report& report) {
  nlohmann::ordered_json line;
  line["stage"] = name_of(report.where);
  line["verdict"] = name_of(report.how);
  auto& all = line["diagnoses"] = nlohmann::ordered_json::array();
  for (const diagnosis what : report.found) {
    const diagnosis_words& words = words_of(what);
    nlohmann::ordered_json each;
    each["name"] = words.name;
    each["cause"] = words.cause;
    auto& others = each["or"] = nlohmann::ordered_json::array();
    for (const diagnosis other : words.or_else) others.push_back(words_of(other).name);
    each["try"] = words.advice;
    all.push_back(std::move(each));
  }
  auto& evidence = line["evidence"] = nlohmann::ordered_json::object();
  for (const fact& each : report.facts) {
    std::visit([&](const auto& value) { evidence[each.name] = value; }, each.value);
  }
  if (!report.remark.empty()) line["remark"] = report.remark;
  const auto replace = nlohmann::ordered_json::error_handler_t::replace;
  return line.dump(-1, ' ', false, replace) + "\n";
}

/// The last line, for people.
std::string summary_of(std::span<const stage_report> stages) {
  std::vector<diagnosis> found;
  for (const stage_report& each : stages) {
    for (const diagnosis what : each.found) found.push_back(what);
  }
  if (found.empty()) return "healthy: nothing is wrong\n";
  return fmt::format("found: {}\n", names_of(found));
}

class consultation {
 public:
  explicit consultation(const doctor_options& options)
      : options_(options), out_(options.common->output), colored_(wants_color(out_.descriptor())) {}

  int run() {
    std::string source = options_.common->source;
    simulated_port simulated;
    if (source == "-") throw bad_value("doctor wants a device, and no bytes from standard input");
    if (kind_of(source) == source_kind::simulated) {
      simulated = serve_simulated(source);
      source = simulated.path;
    }
    const std::function<void(const stage_report&)> tell = [&](const stage_report& report) {
      tell_stage(report);
    };
    auto line = open_examined(source, options_.common->baud, tell);
    if (line) examine(std::move(line), tell);
    if (!options_.json && interrupt() == 0) out_.write(summary_of(stages_));
    out_.commit();
    return interrupt() != 0 ? 128 + interrupt() : static_cast<int>(exit_code_of(stages_));
  }

 private:
  void examine(std::unique_ptr<g4lidar::transport> line,
               const std::function<void(const stage_report&)>& tell) {
    exam_options how;
    if (options_.common->duration.count() > 0) how.listen_ns = options_.common->duration.count();
    how.is_interrupted = [] { return interrupt() != 0; };
    const std::string path(line->name());
    if (has_baud_rates(path)) {
      how.at_rate = [path](std::uint32_t rate) -> std::unique_ptr<g4lidar::transport> {
        auto opened = g4lidar::serial_port::open(path, {.baud = rate});
        return opened ? std::move(*opened) : nullptr;
      };
    }
    examination(std::move(line), std::move(how), tell).run();
  }

  void tell_stage(const stage_report& report) {
    stages_.push_back(report);
    out_.write(options_.json ? json_of(report) : text_of(report, colored_));
    out_.flush();
  }

  const doctor_options& options_;
  output out_;
  bool colored_;
  std::vector<stage_report> stages_;
};

}  // namespace

verb make_doctor_verb() {
  const auto options = std::make_shared<doctor_options>();
  verb made;
  made.name = "doctor";
  made.summary = "What is wrong with a lidar, its line or its port, and what to try";
  made.arguments.push_back(source_argument(options->common));
  made.options.push_back(output_row(options->common));
  made.options.push_back({.names = "--json",
                          .value = "",
                          .help = "A JSON object for each stage, a line each",
                          .take = [options](const std::string&) { options->json = true; }});
  for (option_row& row : ending_rows(options->common)) {
    if (row.names != "-d,--duration") continue;
    row.help = "Listen to the scan for so long (5s)";
    made.options.push_back(std::move(row));
  }
  for (option_row& row : device_rows(options->common)) {
    if (row.names == "--baud") made.options.push_back(std::move(row));
  }
  made.details =
      "It goes through port, permission, holder, baud rate, answer, identity, health, motor, "
      "stream,\n"
      "rate, loss and USB latency, and tells of each what was measured; of what is wrong also the\n"
      "likely cause and what to try. It takes about 8 seconds on a healthy lidar. It changes no\n"
      "setting, and leaves the motor standing. A stage that only warns leaves the exit code at 0;\n"
      "else that is the one of the first stage that failed.";
  made.examples = {"g4-dump doctor", "g4-dump doctor --json -d 30s /dev/ttyUSB0",
                   "g4-dump doctor 'sim:?fault=flip'"};
  made.run = [options] { return consultation(*options).run(); };
  return made;
}

}  // namespace g4_dump
