// SPDX-License-Identifier: MIT
// The table of verbs and options, and the texts of the help. The command line, the man pages and the
// completions are generated from it. Each program creates its own verbs.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace g4_tool {

/// Thrown by option_row::take and verb::run for an invalid value. The message describes the error,
/// without the option's name and without a full stop.
class bad_value : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// What a value is: the completion of a shell offers that. A file is an input, which no output of the command replaces
/// (io/command_files.hpp), or an output.
enum class completion : unsigned char { nothing, input, output, source, choices, setting, fault };

/// An option, or an argument if `names` does not begin with a dash. An option with an empty `value`
/// is a flag.
struct option_row {
  std::string names{};                             ///< "-o,--output"; an argument: "SOURCE".
  std::string value{};                             ///< "FILE", "csv|jsonl|text"; empty for a flag.
  std::string help{};                              ///< One line; the default in parentheses.
  std::function<void(const std::string&)> take{};  ///< Called with each value; "" for a flag.
  completion complete = completion::nothing;       ///< choices: the words of `value`.
  bool repeatable = false;                         ///< May be given several times.
  bool required = false;
  std::string group{};                  ///< Its heading in the help; empty: Options.
  std::vector<std::string> excludes{};  ///< Options that cannot be combined with this one.
  /// For a flag: the name of the value that may follow after `=` and is passed to `take`.
  std::string optional_value{};

  /// "--output" of "-o,--output"; the name of an argument.
  [[nodiscard]] std::string long_name() const { return names.substr(names.rfind(',') + 1); }
  /// Whether `name` is one of `names`.
  [[nodiscard]] bool has_name(const std::string& name) const {
    return ("," + names + ",").find("," + name + ",") != std::string::npos;
  }
};
using option_rows = std::vector<option_row>;

/// A command line to copy, and its description without a full stop.
struct example {
  std::string line;
  std::string words;
};

/// One verb. Its rows write into the options that `run` reads and owns.
struct verb {
  std::string name{};
  std::string summary{};  ///< A line.
  option_rows arguments{};
  option_rows options{};
  /// Paragraphs with empty lines between them, in lines of at most 98 characters; indented lines
  /// are rows "name  meaning" of a table.
  std::string details{};
  std::vector<example> examples{};
  std::vector<int> exits{};    ///< The possible exit codes; empty: all.
  std::function<int()> run{};  ///< Returns the exit code; throws a failure.
};

/// A program: its verbs and the texts of its help. The views are valid for the whole run.
struct program {
  std::string_view name;         ///< "g4-dump".
  std::string_view title;        ///< A line for the help, without a full stop.
  std::string_view description;  ///< Paragraphs of the man page.
  /// In the order of the help. The name of the only verb is not part of the command line.
  std::vector<verb> (*verbs)();
  std::string_view default_verb;  ///< The verb if the command line names none.
  /// If set: runs for an empty command line on a terminal. Returns the exit code.
  int (*overview)() = nullptr;
  bool has_config =
      false;  ///< --config reads options from a TOML file. For a program with one verb.
};

/// The running program. Set by run_program().
[[nodiscard]] const program& this_program() noexcept;

/// The arguments of run_program(), without the program's name.
[[nodiscard]] const std::vector<std::string>& command_line() noexcept;

/// The exit codes and their meanings.
struct exit_code_row {
  int code;
  std::string_view meaning;
};
inline constexpr std::array<exit_code_row, 12> exit_codes{{
    {0, "success"},
    {2, "invalid command line"},
    {3, "no device found"},
    {4, "permission denied"},
    {5, "device in use by another program"},
    {6, "no answer, or wrong baud rate"},
    {7, "another device answered"},
    {8, "the device reports an error or does not obey"},
    {9, "connection lost"},
    {10, "file cannot be read or written"},
    {11, "out of memory or internal error"},
    {130, "ended by ^C (128 + the number of the signal)"},
}};

/// The codes in `wanted`; all if that is empty.
[[nodiscard]] inline std::vector<exit_code_row> exit_code_rows(const std::vector<int>& wanted) {
  std::vector<exit_code_row> rows(exit_codes.begin(), exit_codes.end());
  std::erase_if(rows, [&wanted](const exit_code_row& row) {
    return !wanted.empty() && std::ranges::find(wanted, row.code) == wanted.end();
  });
  return rows;
}

/// The forms of SOURCE.
struct source_form {
  std::string_view form;
  std::string_view meaning;
};
inline constexpr std::array<source_form, 7> source_forms{{
    {"/dev/ttyUSB0", "a serial port"},
    {"serial:2021101000070073", "the lidar with this serial number, at any port"},
    {"usb:1-1.4", "the port at this place on the USB bus"},
    {"tcp:HOST:PORT", "a network bridge that forwards raw bytes"},
    {"FILE, -", "a recording, or raw bytes; - is standard input"},
    {"file:FILE", "the same, whatever its name"},
    {"sim:", "a simulated lidar; sim:?model=MODEL&world=FILE&fault=FAULT"},
}};

/// main() of every program: runs the verb of the command line and reports errors. Returns the exit code.
[[nodiscard]] int run_program(const program& run, int argc, const char* const* argv) noexcept;

/// Parses the command line. Returns the function that runs the command and returns the exit code.
/// --help, --version and errors are handled before it returns.
[[nodiscard]] std::function<int()> read_command_line(int argc, const char* const* argv);

/// "PROBLEM. See: COMMAND --help".
[[nodiscard]] std::string with_help(const std::string& problem, std::string_view command);

/// `--generate man DIRECTORY`, which the build runs: writes the man pages. Returns the exit code.
[[nodiscard]] int write_man_pages(const std::string& directory);

/// `--complete WORD...`, which the completion scripts run: prints the completions of the last word
/// (which may be empty), each with a tab and its description; `/` requests the names of files.
/// Returns the exit code.
[[nodiscard]] int complete(std::span<const std::string> words);

}  // namespace g4_tool
