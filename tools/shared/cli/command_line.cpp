// SPDX-License-Identifier: MIT
// Parses the command line with CLI11, which no other source includes.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <ranges>
#include <span>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include "common_options.hpp"
#include "config_file.hpp"
#include "exit_code.hpp"
#include "io/output.hpp"
#include "logger.hpp"
#include "suggestion.hpp"
#include "verbs.hpp"

namespace g4_tool {
extern const char build_version[];  // cmake/version.sh
namespace {

/// A name for CLI11, which refuses `=` in names from version 2.4 on.
std::string accepted_name(std::string names) {
  std::ranges::replace(names, '=', '-');
  return names;
}

/// Prints the optional value of a flag without a space before it (--speckle[=LIMITS]), and the name of
/// an argument as it was before accepted_name() (NAME=VALUE).
class help_formatter final : public CLI::Formatter {
  std::string make_option_name(const CLI::Option* option, bool is_argument) const override {
    std::string name = CLI::Formatter::make_option_name(option, is_argument);
    if (is_argument) std::ranges::replace(name, '-', '=');
    return name;
  }

  std::string make_option_opts(const CLI::Option* option) const override {
    const std::string text = CLI::Formatter::make_option_opts(option);
    return text.starts_with(" [=") ? text.substr(1) : text;
  }
};

/// Reads the file of --config. A flag that is false there counts as not given.
class config_reader final : public CLI::ConfigBase {
  std::vector<CLI::ConfigItem> from_config(std::istream& in) const override {
    std::string problem;
    std::istringstream text(config_text(in, problem));
    if (!problem.empty()) throw CLI::FileError("--config: " + problem);
    std::vector<CLI::ConfigItem> lines = CLI::ConfigBase::from_config(text);
    std::erase_if(lines, [](const CLI::ConfigItem& line) {
      return line.inputs == std::vector<std::string>{"false"};
    });
    return lines;
  }
};

void add(CLI::App& app, const option_row& row) {
  const std::string name = row.long_name();
  // CLI11 itself adds the name of a flag with a value.
  const bool adds_name = name.starts_with('-') && row.optional_value.empty();
  const bool is_read = row.complete == completion::input || row.complete == completion::source;
  const auto take = [inner = row.take, is_read,
                     before = adds_name ? name + ": " : ""](const std::string& word) {
    if (is_read) add_input(word);
    try {
      inner(word);
    } catch (const bad_value& reason) {
      throw CLI::ValidationError(before + reason.what());
    }
  };
  CLI::Option* option = nullptr;
  if (!row.optional_value.empty()) {
    const auto given = std::make_shared<std::string>();
    option = app.add_flag(row.names, *given, row.help)->disable_flag_override(false);
    option->option_text("[=" + row.optional_value + "]");
    option->each([take, given](const std::string& word) { take(word == "true" ? "" : word); });
  } else if (row.value.empty() && name.starts_with('-')) {
    option = app.add_flag_function(row.names, [take](std::int64_t) { take(""); }, row.help);
  } else {
    const bool is_list = row.repeatable && !name.starts_with('-');
    const auto take_all = [take](const std::vector<std::string>& words) {
      std::ranges::for_each(words, take);
    };
    option = app.add_option_function<std::vector<std::string>>(accepted_name(row.names), take_all,
                                                               row.help)
                 ->type_name(row.value)
                 ->expected(1, is_list ? CLI::detail::expected_max_vector_size : 1)
                 ->allow_extra_args(is_list)
                 ->required(row.required)
                 ->multi_option_policy(row.repeatable ? CLI::MultiOptionPolicy::TakeAll
                                                      : CLI::MultiOptionPolicy::Throw);
  }
  if (!row.group.empty()) option->group(row.group);
}

std::string exit_code_list(const std::vector<int>& wanted) {
  std::string text = "Exit codes:";
  for (const auto& [code, meaning] : exit_code_rows(wanted)) {
    text += fmt::format("{} {} {}", text.back() == ':' ? "" : ",", code, meaning);
  }
  return wrapped(text + '.', 0, 0);
}

std::string footer_of(const verb& shown) {
  std::string text = shown.details;
  if (!shown.examples.empty()) text += "\n\nExamples:";
  for (const example& each : shown.examples) text += "\n  " + each.line + "\n      " + each.words;
  return text + (text.empty() ? "" : "\n\n") + exit_code_list(shown.exits);
}

/// Adds the arguments and options of `added` to `made`.
void fill(CLI::App& made, const verb& added) {
  for (const option_row& row : added.arguments) add(made, row);
  for (const option_row& row : added.options) add(made, row);
  for (const option_row& row : added.options) {
    CLI::Option* const option = made.get_option(row.long_name());
    for (const std::string& other : row.excludes) option->excludes(made.get_option(other));
  }
}

CLI::App* add(CLI::App& app, const verb& added) {
  CLI::App* const made = app.add_subcommand(added.name, added.summary)->group("Commands");
  made->footer(footer_of(added));
  fill(*made, added);
  return made;
}

std::string unknown_verb(const std::string& word) {
  const std::vector<verb> verbs = this_program().verbs();
  const auto names = verbs | std::views::transform(&verb::name);
  return fmt::format("unknown command {}; commands are: {}{}", in_quotes(word),
                     fmt::join(names, ", "), did_you_mean(word, {names.begin(), names.end()}));
}

/// The long names of the options of the program and of the chosen command.
std::vector<std::string> option_names(const CLI::App& app, std::string_view dashes) {
  std::vector<const CLI::App*> both{&app};
  for (const CLI::App* const chosen : app.get_subcommands()) both.push_back(chosen);
  std::vector<std::string> names;
  for (const CLI::App* const each : both) {
    for (const CLI::Option* const option : each->get_options()) {
      for (const std::string& name : option->get_lnames()) {
        names.push_back(std::string(dashes) + name);
      }
    }
  }
  return names;
}

/// The error of the command line, without a full stop.
std::string problem_with(const CLI::App& app, const CLI::ParseError& error) {
  const bool has_verb = !app.get_subcommands().empty() || app.get_subcommands({}).empty();
  const std::vector<std::string> rest = app.remaining(has_verb);
  const bool has_extra = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
  if (!rest.empty() && (has_extra || !has_verb)) {
    const std::string& word = rest.front();
    if (!word.starts_with('-')) {
      return has_verb ? "unexpected argument " + in_quotes(word) : unknown_verb(word);
    }
    return "unknown option " + in_quotes(word) +
           did_you_mean(word.substr(0, word.find('=')), option_names(app, "--"));
  }
  std::string words = error.what();
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr) {
    const std::string name = words.substr(0, words.find_first_of(": "));
    const auto has = [&words](const char* what) { return words.find(what) != std::string::npos; };
    words = has("flag override") ? "--" + name + " takes no value"
            : has("At Most")     ? name + " is given twice"
                                 : name + " needs one value";
  }
  constexpr std::string_view unknown = "INI was not able to parse ";
  if (words.starts_with(unknown)) {
    words = problem_in_file(words.substr(unknown.size()), option_names(app, ""));
  }
  constexpr std::string_view unreadable = " was not readable (missing?)";
  if (words.ends_with(unreadable)) {
    words = "--config: cannot read " + in_quotes(words.substr(0, words.size() - unreadable.size()));
  }
  constexpr std::string_view excludes = " excludes ";
  const std::size_t at = words.find(excludes);
  if (at != std::string::npos) words.replace(at, excludes.size(), " cannot be used with ");
  if (!words.empty() && words.back() == '.') words.pop_back();
  return words;
}

int report_usage_error(const std::string& problem, const std::string& verb) {
  logger::error(with_help(problem, fmt::format("{}{}", this_program().name, verb)),
                exit_code::usage);
  return static_cast<int>(exit_code::usage);
}

/// `chosen.run`. A bad_value that it throws is reported as an error of the command line.
std::function<int()> guarded(const verb& chosen) {
  const bool is_named = chosen.name != this_program().name;
  return [run = chosen.run, name = is_named ? " " + chosen.name : std::string()] {
    try {
      return run();
    } catch (const bad_value& reason) {
      return report_usage_error(reason.what(), name);
    }
  };
}

/// How many words at `offset` belong to a global option, which may precede the verb; 0: none.
std::size_t global_option_words(const std::vector<std::string>& words, std::size_t offset) {
  const std::string& word = words[offset];
  if (word == "--color") return 2;
  if (word == "--quiet" || word == "--verbose" || word == "--json-errors") return 1;
  if (word.starts_with("--color=")) return 1;
  const bool is_short = word.size() > 1 && word.front() == '-';
  return is_short && word.find_first_not_of("qv", 1) == std::string::npos ? 1 : 0;
}

/// Whether the command line has no verb, because an option of the default verb or a source stands in
/// its place. `--help` and `--version` belong to the program. The name of a file can have any form.
bool has_no_verb(const std::vector<std::string>& words, const std::vector<verb>& verbs) {
  std::size_t at = 0;
  while (at < words.size() && global_option_words(words, at) > 0)
    at += global_option_words(words, at);
  if (at >= words.size()) return this_program().overview == nullptr || ::isatty(1) == 0;
  const std::string& first = words[at];
  if (first == "-h" || first == "--help" || first == "--version") return false;
  if (first.empty() || first.front() == '-') return true;
  if (std::ranges::find(verbs, first, &verb::name) != verbs.end()) return false;
  std::error_code unimportant;
  return first.find_first_of("/:.") != std::string::npos ||
         std::filesystem::is_regular_file(first, unimportant);
}

std::string source_list() {
  std::string text;
  for (const source_form& each : source_forms) {
    text += fmt::format("  {:<25}{}\n", each.form, each.meaning);
  }
  return text;
}

std::string app_footer(const program& ours) {
  return fmt::format(
      "\nThe default command is {}. On a terminal, without any word, the attached lidars and the "
      "commands\nare listed. The default SOURCE is the only lidar. Other sources:\n{}Data goes to "
      "standard output, messages go to standard error.\n{}\nHelp for a command: {} COMMAND --help, "
      "or man {}-COMMAND",
      ours.default_verb, source_list(), exit_code_list({}), ours.name, ours.name);
}

/// What the help has besides the verbs, and the options of all of them.
void describe(CLI::App& app, const program& ours, const std::vector<verb>& verbs) {
  app.set_version_flag("--version", fmt::format("{} {}", ours.name, build_version),
                       "Print the version and exit");
  app.fallthrough();
  app.require_subcommand(0, 1);  // a further one is an argument
  app.option_defaults()->disable_flag_override();
  app.footer(verbs.size() == 1 ? "\nThe default SOURCE is the only lidar. Other sources:\n" +
                                     source_list() + "\n" + footer_of(verbs.front())
                               : app_footer(ours));
  if (ours.has_config) {
    app.set_config("--config", "", "Read options from a TOML file")->type_name("FILE");
    app.config_formatter(std::make_shared<config_reader>());
    app.allow_config_extras(CLI::config_extras_mode::error);
  }
  app.formatter(std::make_shared<help_formatter>());
  app.get_formatter()->label("SUBCOMMAND", "COMMAND");
  app.get_formatter()->label("Positionals", "Arguments");
  app.get_formatter()->column_width(36);
  for (const option_row& row : global_rows()) add(app, row);
}

}  // namespace

std::string with_help(const std::string& problem, std::string_view command) {
  return fmt::format("{}{} See: {} --help", problem, problem.ends_with('?') ? "" : ".", command);
}

std::function<int()> read_command_line(int argc, const char* const* argv) {
  std::vector<std::string> words(argv + 1, argv + argc);  // NOLINT: the length is given
  if (words.size() == 3 && words[0] == "--generate" && words[1] == "man") {
    return [directory = words[2]] { return write_man_pages(directory); };
  }
  if (words.size() >= 2 && words[0] == "--complete") {
    return [words] { return complete(std::span(words).subspan(1)); };
  }
  const program& ours = this_program();
  const std::vector<verb> verbs = ours.verbs();
  if (!words.empty() && words.front() == "help") {
    if (words.size() > 1 && std::ranges::find(verbs, words[1], &verb::name) == verbs.end()) {
      return [what = words[1]] { return report_usage_error(unknown_verb(what), ""); };
    }
    std::ranges::rotate(words, words.begin() + 1);
    words.back() = "--help";
  }
  CLI::App app(std::string(ours.title), std::string(ours.name));
  describe(app, ours, verbs);
  std::function<int()> chosen;
  if (verbs.size() == 1) {
    fill(app, verbs.front());
    app.callback([&chosen, &verbs] { chosen = guarded(verbs.front()); });
  } else {
    for (const verb& each : verbs) {
      add(app, each)->callback([&chosen, &each] { chosen = guarded(each); });
    }
    if (has_no_verb(words, verbs)) words.insert(words.begin(), std::string(ours.default_verb));
  }
  std::reverse(words.begin(), words.end());  // as CLI11 takes them
  const auto done = [](int code) { return [code] { return code; }; };
  try {
    app.parse(words);
  } catch (const CLI::Success& wanted) {  // --help, --version
    std::ostringstream text;
    const int code = app.exit(wanted, text, text);
    output out("-");
    out.write(text.str());
    out.commit();
    return done(code);
  } catch (const CLI::ParseError& error) {
    const std::vector<CLI::App*> named = app.get_subcommands();
    return done(report_usage_error(problem_with(app, error),
                                   named.empty() ? "" : " " + named.back()->get_name()));
  }
  if (const CLI::Option* const config = app.get_config_ptr()) {
    for (const std::string& name : config->results()) add_input(name);
  }
  return chosen ? chosen : ours.overview;
}

}  // namespace g4_tool
