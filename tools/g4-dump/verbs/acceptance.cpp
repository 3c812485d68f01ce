// SPDX-License-Identifier: MIT
// The verb acceptance: compares a real lidar with the table of models, with the help of its user.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "acceptance/kit_rows.hpp"
#include "cli/common_options.hpp"
#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "g4lidar/recording/writer.hpp"
#include "g4lidar/transport/transport.hpp"
#include "io/command_files.hpp"
#include "io/command_source.hpp"
#include "io/interrupt.hpp"
#include "io/output.hpp"
#include "io/recorder.hpp"
#include "io/source_word.hpp"
#include "verbs/dump_verbs.hpp"

namespace g4_tool {
namespace {

using acceptance::user_action;

constexpr std::size_t indent = 16;
constexpr std::size_t answer_indent = 7;

struct acceptance_settings : common_options {
  /// Beside those of the source.
  struct choices {
    std::string file = "acceptance.mcap";
    bool is_alone = false;
  } run;
};

/// A line of standard input; nothing at its end, and after a signal.
std::optional<std::string> read_line() {
  std::string line;
  while (wait_for_input(STDIN_FILENO, -1) == wake::input) {
    char next = 0;
    if (::read(STDIN_FILENO, &next, 1) != 1) return std::nullopt;
    if (next == '\n') return line;
    line += next;
  }
  return std::nullopt;
}

std::string_view task_of(user_action what) noexcept {
  switch (what) {
    case user_action::place_near:
      return "Place a flat target straight ahead of the lidar, opposite to its cable, 0.3 m to 1 m "
             "away. Nothing else may be nearer. Five degrees are 9 cm at a distance of 1 m. "
             "Measure its "
             "distance from the middle of the head.";
    case user_action::place_far:
      return "Place the target 2 m to 5 m away in the same direction, or remove it if there is a "
             "wall. Measure the distance.";
    case user_action::unplug:
      return "Press Enter, and then unplug the USB cable of the lidar within 2 minutes.";
    case user_action::plug_in:
      return "Press Enter, and then plug the cable in again within 2 minutes.";
  }
  return {};
}

/// The answer of the user; asks again until it is one.
std::optional<double> ask_user(user_action what) {
  const bool wants_distance = what == user_action::place_near || what == user_action::place_far;
  constexpr double longest_mm = 100'000.0;
  logger::info(fmt::format("{}\n", task_of(what)));
  while (true) {
    logger::info(wants_distance ? "Distance in mm, or s to skip this step:\n"
                                : "Enter, or s to skip this step:\n");
    const auto line = read_line();
    if (!line || *line == "s") return std::nullopt;
    if (!wants_distance) return 0.0;
    double value_mm = 0.0;
    const char* const end = line->data() + line->size();
    const auto [rest, wrong] = std::from_chars(line->data(), end, value_mm);
    if (wrong == std::errc() && rest == end && value_mm > 0.0 && value_mm <= longest_mm) {
      return value_mm;
    }
    logger::info(fmt::format("{} is no distance in mm, such as 640.\n", in_quotes(*line)));
  }
}

nlohmann::ordered_json json_of_step(const acceptance::step_result& of) {
  nlohmann::ordered_json line{{"step", name_of(of.of)},
                              {"verdict", name_of(of.outcome)},
                              {"evidence", nlohmann::ordered_json::object()},
                              {"text", of.text}};
  for (const evidence& each : of.facts)
    std::visit([&](const auto& value) { line["evidence"][each.name] = value; }, each.value);
  return line;
}

std::string text_of_step(const acceptance::step_result& of) {
  std::string measured;
  for (const evidence& each : of.facts) {
    measured +=
        fmt::format("{}{} {}", measured.empty() ? "" : ", ", each.name, printable(each.text()));
  }
  std::string text = fmt::format("{:<15} {:<9}", name_of(of.of), name_of(of.outcome));
  text += wrapped(" " + printable(of.text), indent + 9, indent) + "\n";
  if (!measured.empty()) {
    text += std::string(indent, ' ') + wrapped(measured, indent, indent) + "\n";
  }
  return text;
}

/// Each open question with its answer, or with the reason why it has none.
std::string questions_of(const model& model, const std::vector<acceptance::step_result>& all) {
  constexpr std::array<std::string_view, 3> marks{"open", "-", "yes"};
  std::string text =
      "\nOpen questions (yes: answered; -: does not arise with this model; open: not decided):\n";
  auto row = acceptance::question_rows().begin();
  for (const acceptance::question_answer& each : answers_of(model, all)) {
    text += fmt::format("  {:<5}", marks.at(static_cast<std::size_t>(each.how)));
    text += wrapped(fmt::format("{} {}", (row++)->text, printable(each.text)), answer_indent,
                    answer_indent) +
            "\n";
  }
  return text;
}

/// The port of the name, as the system knows it.
std::optional<port_info> port_of(std::string_view name) {
  const auto ports = list_ports();
  if (!ports) return std::nullopt;
  const auto found = std::ranges::find(*ports, name, &port_info::path);
  return found == ports->end() ? std::nullopt : std::optional(*found);
}

/// Gives the connection that is open already, and then those of `inner`.
class opened_connector final : public forwarding_connector {
 public:
  opened_connector(std::unique_ptr<connector> inner, std::unique_ptr<transport> opened)
      : forwarding_connector(std::move(inner)), opened_(std::move(opened)) {}
  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override {
    if (opened_) return std::move(opened_);
    return inner().connect();
  }

 private:
  std::unique_ptr<transport> opened_;
};

/// Sets model and baud rate of `options` to those of the lidar behind `port`, if the user has named no model. Throws a
/// failure, or a bad_value if the bytes fit several models.
void recognise(acceptance_settings& options, transport& port) {
  constexpr std::int64_t search_ns = 3'000'000'000;
  const auto found = search(port, port.now_ns() + search_ns,
                            {.baud = options.expected.baud,
                             .may_pulse_dtr = !options.source.empty(),
                             .is_cancelled = [] { return interrupt() != 0; }});
  if (!found && interrupt() != 0) throw interrupted();
  if (!found) throw failure_of(options, found.error());
  if (found->candidates.size() > 1) {
    std::vector<std::string_view> words;
    for (const model* each : found->candidates) words.push_back(each->word);
    throw bad_value(fmt::format("the bytes are those of several models: --model names one of {}",
                                fmt::join(words, ", ")));
  }
  logger::info(fmt::format("recognised: {}\n", found->model->name));
  options.expected.model = found->model;
  if (options.expected.baud == 0) options.expected.baud = found->baud;
}

/// The open connection to the lidar, whose model is known then. Throws a failure.
std::unique_ptr<connector> connect(acceptance_settings& options) {
  if (options.expected.model == nullptr)
    options.expected.model = value_of(model_in_source(options.source));
  acceptance_settings as_found = options;
  // Opened at the rate of a model, and not searched.
  if (as_found.expected.model == nullptr) as_found.expected.model = &g4_model;
  auto from = connector_for(options_for(as_found, {}));
  if (!from) throw failure_of(options, from.error());
  auto port = (*from)->connect();
  if (!port) throw failure_of(options, port.error());
  if (options.expected.model == nullptr) recognise(options, **port);
  return std::make_unique<opened_connector>(*std::move(from), *std::move(port));
}

/// "g4-dump set --model t-mini /dev/ttyUSB0 frequency=10".
std::string command_to_set(const acceptance_settings& options, const std::string& words) {
  const std::string model = options.source.find("model=") == std::string::npos
                                ? fmt::format(" --model {}", options.expected.model->word)
                                : "";
  const std::string source = options.source.empty() ? "" : " '" + options.source + "'";
  return fmt::format("g4-dump set{}{} {}", model, source, words);
}

acceptance::run_options options_of(const acceptance_settings& options) {
  acceptance::run_options how;
  how.model = options.expected.model;
  how.baud = options.expected.baud;
  if (options.duration.count() > 0)
    how.stream_time = std::chrono::ceil<std::chrono::milliseconds>(options.duration);
  if (!options.run.is_alone) how.ask = ask_user;
  how.is_cancelled = [] { return interrupt() != 0; };
  how.on_step = [](acceptance::step of) { logger::info(fmt::format("{} ...\n", name_of(of))); };
  how.on_lost_settings = [&options](const std::string& words) {
    logger::info(fmt::format("The settings could not be set back. This does it: {}\n",
                             command_to_set(options, words)));
  };
  return how;
}

int accept(const acceptance_settings& given) {
  output out(given.output);
  refuse_files(given, task::asking);
  const claimed_output claim(given.run.file);
  acceptance_settings options = given;
  auto from = connect(options);
  acceptance::run_options how = options_of(options);
  auto file = recording_writer::create(
      options.run.file, {.model = how.model, .overwrite = may_replace(), .scans = false});
  if (!file) throw file_failure(file.error(), options.run.file, false);
  auto observed = recorded(std::move(from), *file);
  if (!observed) throw failure(observed.error());

  const auto port = select_port(options.source);
  const std::optional<port_info> known = port ? port_of(port->path) : std::nullopt;
  if (known) how.port = &*known;
  std::optional<error> unwritten;
  const auto cannot_write = [&] {
    if (!unwritten) unwritten = file->take_error();
    return unwritten.has_value();
  };
  how.is_cancelled = [&] { return interrupt() != 0 || cannot_write(); };
  how.on_result = [&](const acceptance::step_result& done) {
    out.write(options.json ? json_line(json_of_step(done)) : text_of_step(done));
    out.flush();
  };
  if (!options.json)
    out.write(fmt::format("Compared with the {} of the table of models:\n", how.model->name));
  const auto [all, lost] = acceptance::run(**observed, how);

  std::vector<std::pair<std::string, std::string>> words{{"model", std::string(how.model->word)}};
  for (const acceptance::step_result& each : all)
    words.emplace_back(name_of(each.of), json_of_step(each).dump());
  file->metadata("g4lidar.acceptance", words);
  const auto closed = file->close();
  static_cast<void>(cannot_write());
  if (!unwritten && !closed) unwritten = closed.error();
  if (unwritten) throw file_failure(*unwritten, options.run.file, file->counts().chunks > 0);
  if (!options.json) out.write(questions_of(*how.model, all));
  out.commit();
  logger::info(fmt::format("{} has all bytes and these results. Attach it to a report: {}\n",
                           in_quotes(options.run.file), G4LIDAR_ISSUES));
  if (interrupt() != 0) return 128 + interrupt();
  if (lost) throw failure_of(options, *lost);
  const bool differs = std::ranges::find(all, acceptance::finding::differs,
                                         &acceptance::step_result::outcome) != all.end();
  return static_cast<int>(differs ? exit_code::unhealthy : exit_code::ok);
}

constexpr const char* acceptance_details =
    R"(It compares a lidar with the model of --model in the table of models, or with the one that
its bytes show; if they fit several models, name it. It takes about 20 minutes: identity, each
command with its answer and time, frequencies and sample rates, start and stop, DTR, a minute of
the scan with its CT bytes, lower bits and time packets. It asks its user for a target that is
near, one that is far, and an unplug; s skips such a step, and --alone all of them. Settings are
changed. However it ends, with ^C too, they are set back and the motor is stopped; where that is not
possible, the command that does it is printed. docs/models.md lists which models need
such a run most: nobody has tried them with a real device.

The output is a page of text: for each step agrees, observed (not in the table), not_done or
differs, and what was measured. Then it lists the questions that only a real device can answer: yes
with the answer, - where it does not arise with this model, and open with the reason. The file
contains all bytes in both directions and these results; it is a recording, which every other
command reads. A step that differs makes the exit code 8.)";

}  // namespace

verb make_acceptance_verb() {
  const auto options = std::make_shared<acceptance_settings>();
  option_row file = text_row("--file", "FILE", "The file for a report (acceptance.mcap)",
                             options->run.file, completion::output);
  return {.name = "acceptance",
          .summary = "Compare a real lidar with the table of models, for a report",
          .arguments = {source_argument(*options)},
          .options = joined(
              output_rows(*options), json_row(*options, "A JSON object for each step, a line each"),
              duration_row(*options, "Observe the scan for so long (1m)"),
              rows_of("Device", {"baud"}, options->expected), row_of("model", options->expected),
              rows_of("Device", {"probe_all_ports"}, options->expected),
              option_rows{file, flag_row("--alone", "Leave out the steps that need a user",
                                         options->run.is_alone)}),
          .details = acceptance_details,
          .examples = {{"g4-dump acceptance --model x4 /dev/ttyUSB0", "Examine an X4"},
                       {"g4-dump acceptance --alone --file g4.mcap sim:",
                        "A simulated G4, without its user"}},
          .run = [options] { return accept(*options); }};
}

}  // namespace g4_tool
