// SPDX-License-Identifier: MIT
// The table of verbs as CLI11 wants it; the only place that sees CLI11.
#include "command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "exit_code.hpp"
#include "file_id.hpp"
#include "g4lidar/version.hpp"
#include "manners.hpp"
#include "manual.hpp"
#include "report.hpp"
#include "verb.hpp"
#include "verbs.hpp"

namespace g4_dump {
namespace {

constexpr std::string_view default_verb = "dump";

/// Words that CLI11 hands to a row; what is wrong with one gets the option's name from CLI11.
void hand_over(const std::function<void(const std::string&)>& take, const std::string& word,
               const std::string& name) {
  try {
    take(word);
  } catch (const bad_value& reason) {
    throw CLI::ValidationError(name, reason.what());
  }
}

/// "--output" of "-o,--output".
std::string long_name(const std::string& names) {
  const std::size_t comma = names.rfind(',');
  return comma == std::string::npos ? names : names.substr(comma + 1);
}

CLI::Option* add(CLI::App& app, const option_row& row) {
  const std::string name = long_name(row.names);
  CLI::Option* option = nullptr;
  if (row.value.empty()) {
    const auto take = row.take;
    option = app.add_flag_function(
        row.names, [take, name](std::int64_t) { hand_over(take, "", name); }, row.help);
  } else {
    const auto take = [row, name](const std::vector<std::string>& words) {
      for (const std::string& word : words) hand_over(row.take, word, name);
    };
    option = app.add_option_function<std::vector<std::string>>(row.names, take, row.help)
                 ->type_name(row.value)
                 ->expected(1)
                 ->allow_extra_args(false)
                 ->multi_option_policy(row.repeatable ? CLI::MultiOptionPolicy::TakeAll
                                                      : CLI::MultiOptionPolicy::Throw);
  }
  if (!row.group.empty()) option->group(row.group);
  return option;
}

void add(CLI::App& app, const argument_row& row) {
  CLI::Option* option = nullptr;
  if (row.repeatable) {
    const auto take = [row](const std::vector<std::string>& words) {
      for (const std::string& word : words) hand_over(row.take, word, row.name);
    };
    option = app.add_option_function<std::vector<std::string>>(row.name, take, row.help);
  } else {
    const auto take = [row](const std::string& word) { hand_over(row.take, word, row.name); };
    option = app.add_option_function<std::string>(row.name, take, row.help);
  }
  option->type_name("")->required(row.required);
}

/// The codes that are among `wanted`, or all, in lines that fit a terminal.
std::string exit_code_list(const std::vector<int>& wanted) {
  constexpr std::size_t width = 98;
  std::string text = "Exit codes:";
  std::size_t begin = 0;  // of the line
  bool first = true;
  for (const exit_code_row& row : exit_codes()) {
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), row.code) == wanted.end()) {
      continue;
    }
    const std::string piece = fmt::format("{} {}", row.code, row.meaning);
    if (!first) text += ',';
    if (text.size() - begin + piece.size() + 2 > width) {
      text += '\n';
      begin = text.size();
    } else {
      text += ' ';
    }
    text += piece;
    first = false;
  }
  return text + '.';
}

std::string footer_of(const verb& shown) {
  std::string text = shown.details;
  if (!shown.examples.empty()) text += "\n\nExamples:";
  for (const std::string& line : shown.examples) text += "\n  " + line;
  return text + (text.empty() ? "" : "\n\n") + exit_code_list(shown.exits);
}

CLI::App* add(CLI::App& app, const verb& added) {
  CLI::App* const made = app.add_subcommand(added.name, added.summary)->group("Verbs");
  made->footer(footer_of(added));
  for (const argument_row& row : added.arguments) add(*made, row);
  for (const option_row& row : added.options) add(*made, row);
  for (const option_row& row : added.options) {
    CLI::Option* const option = made->get_option(long_name(row.names));
    for (const std::string& other : row.needs) option->needs(made->get_option(other));
    for (const std::string& other : row.excludes) option->excludes(made->get_option(other));
  }
  return made;
}

std::string known_verbs(const CLI::App& app) {
  std::string names;
  for (const CLI::App* const each : app.get_subcommands([](const CLI::App*) { return true; })) {
    names += (names.empty() ? "" : ", ") + each->get_name();
  }
  return names;
}

/// What is wrong with the command line, without a full stop.
std::string problem_with(const CLI::App& app, const CLI::ParseError& error) {
  if (app.get_subcommands().empty()) {
    const std::vector<std::string> rest = app.remaining();
    if (rest.empty()) return "say what to do: " + known_verbs(app);
    const bool is_option = rest.front().front() == '-';
    return fmt::format("{} is no {}; say what to do: {}", in_quotes(rest.front()),
                       is_option ? "option" : "verb", known_verbs(app));
  }
  const std::vector<std::string> rest = app.remaining(true);
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr && !rest.empty()) {
    const bool is_option = rest.front().front() == '-';
    return in_quotes(rest.front()) + (is_option ? " is no option" : " is one argument too many");
  }
  std::string words = error.what();
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr) {
    words = words.substr(0, words.find(':')) + " wants one value";
  }
  if (!words.empty() && words.back() == '.') words.pop_back();
  return words;
}

std::string verb_of(const CLI::App& app) {
  std::string name;
  for (const CLI::App* const chosen : app.get_subcommands()) name = " " + chosen->get_name();
  return name;
}

int explain(const std::string& problem, const std::string& verb) {
  report(fmt::format("{}. See: g4-dump{} --help", problem, verb), exit_code::usage);
  return static_cast<int>(exit_code::usage);
}

/// How many words from `at` on are the program's own options, which may stand before the verb; 0:
/// none.
std::size_t own_words(const std::vector<std::string>& words, std::size_t at) {
  const std::string& word = words[at];
  if (word == "--color") return 2;
  if (word == "--quiet" || word == "--verbose" || word == "--json-errors") return 1;
  if (word.starts_with("--color=")) return 1;
  const bool is_short = word.size() > 1 && word.front() == '-';
  return is_short && word.find_first_not_of("qv", 1) == std::string::npos ? 1 : 0;
}

/// Whether an option or a source stands where a verb could: for the verb that needs not be named.
/// `--help` and `--version` are the program's own. A file need not look like one.
bool leaves_out_verb(const std::vector<std::string>& words, const std::vector<verb>& verbs) {
  std::size_t at = 0;
  while (at < words.size() && own_words(words, at) > 0) at += own_words(words, at);
  if (at >= words.size()) return true;
  const std::string& first = words[at];
  if (first == "-h" || first == "--help" || first == "--version") return false;
  if (first.empty() || first.front() == '-') return true;
  const auto is_it = [&first](const verb& each) { return each.name == first; };
  if (std::any_of(verbs.begin(), verbs.end(), is_it)) return false;
  std::error_code unimportant;
  return first.find_first_of("/:.") != std::string::npos ||
         std::filesystem::is_regular_file(first, unimportant);
}

std::string app_footer() {
  return fmt::format(
      "\nWithout a verb: {}. SOURCE is /dev/ttyUSB0, serial:2021101000070073 (the lidar's own\n"
      "number), usb:1-1.4, tcp:HOST:PORT, a recording, raw bytes in a file or -, or sim: (with\n"
      "?world=FILE&seed=N&fault=FAULT); without one: the only G4.\n"
      "Data goes to standard output, words to standard error.\n"
      "{}\n"
      "More about a verb: g4-dump VERB --help",
      default_verb, exit_code_list({}));
}

void say_version() {
  fmt::print("g4-dump {}.{}.{}\n", G4LIDAR_VERSION_MAJOR, G4LIDAR_VERSION_MINOR,
             G4LIDAR_VERSION_PATCH);
}

}  // namespace

std::function<int()> read_command_line(int argc, const char* const* argv) {
  if (argc == 3 && std::string_view(argv[1]) == "--generate") {
    return [what = std::string_view(argv[2])] { return generate(what); };
  }
  const std::vector<verb> verbs = all_verbs();
  CLI::App app("The console tool for the YDLIDAR G4", "g4-dump");
  bool asks_version = false;
  app.add_flag("--version", asks_version, "Print the version and exit");
  app.fallthrough();
  app.footer(app_footer());
  app.get_formatter()->label("SUBCOMMAND", "VERB");
  app.get_formatter()->column_width(36);
  for (const option_row& row : manners_rows()) add(app, row);
  std::vector<std::pair<const CLI::App*, const verb*>> made;
  made.reserve(verbs.size());
  for (const verb& each : verbs) made.emplace_back(add(app, each), &each);
  std::vector<std::string> words(argv + 1, argv + argc);  // NOLINT: the length is given
  if (leaves_out_verb(words, verbs)) words.insert(words.begin(), std::string(default_verb));
  std::vector<std::string> backwards(words.rbegin(), words.rend());  // as CLI11 takes them
  const auto done = [](int code) { return [code] { return code; }; };
  try {
    app.parse(backwards);
    if (asks_version) {
      say_version();
      return done(0);
    }
    app.require_subcommand(1);
  } catch (const CLI::Success& wanted) {  // --help
    return done(app.exit(wanted));
  } catch (const CLI::ParseError& error) {
    return done(explain(problem_with(app, error), verb_of(app)));
  }
  for (const auto& [parsed, each] : made) {
    if (!parsed->parsed()) continue;
    return [run = each->run, name = " " + each->name] {
      try {
        return run();
      } catch (const bad_value& reason) {
        return explain(reason.what(), name);
      }
    };
  }
  return done(explain("say what to do: " + known_verbs(app), ""));
}

}  // namespace g4_dump
