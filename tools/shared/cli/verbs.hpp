// SPDX-License-Identifier: MIT
// The table of verbs and options, and what the help contains beside them: the command line, the man
// pages and the completions are made from it. A program makes its verbs.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace g4_tool {

/// Thrown by option_row::take and verb::run for a value that is not valid: what is wrong with it,
/// without the option's name and without a full stop.
class bad_value : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// What a shell offers for a value.
enum class completion : unsigned char { nothing, file, source, choices, setting, fault };

/// An option, or an argument where `names` begins with no dash. An option with an empty `value` is a
/// flag.
struct option_row {
  std::string names{};                             ///< "-o,--output"; of an argument "SOURCE".
  std::string value{};                             ///< "FILE", "csv|jsonl|text"; empty for a flag.
  std::string help{};                              ///< A line; the default in parentheses.
  std::function<void(const std::string&)> take{};  ///< Of a flag it gets "".
  completion complete = completion::nothing;       ///< choices: the words of `value`.
  bool repeatable = false;                         ///< May be given again.
  bool required = false;
  std::string group{};                  ///< Its heading in the help; empty: Options.
  std::vector<std::string> excludes{};  ///< Refused together with these.
  /// Of a flag: the value that it may have after `=`; then `take` gets it.
  std::string optional_value{};
};
using option_rows = std::vector<option_row>;

/// A command line that can be copied, and what it does: words without a full stop.
struct example {
  std::string line;
  std::string words;
};

/// One verb. Its rows write into what `run` reads and keeps alive.
struct verb {
  std::string name{};
  std::string summary{};  ///< A line.
  option_rows arguments{};
  option_rows options{};
  /// Paragraphs with empty lines between them, in lines of at most 98 characters; indented lines
  /// are rows "name  meaning" of a table.
  std::string details{};
  std::vector<example> examples{};
  std::vector<int> exits{};    ///< The exit codes that it can have; empty: all.
  std::function<int()> run{};  ///< Returns the exit code; throws a failure.
};

/// A program: its verbs, and the words of its help. All names are valid forever.
struct program {
  std::string_view name;         ///< "g4-dump".
  std::string_view title;        ///< A line for the help, without a full stop.
  std::string_view description;  ///< Paragraphs of the man page.
  std::vector<verb> (
      *verbs)();  ///< In the order of the help. A single one is not named on the command line.
  std::string_view default_verb;  ///< The verb that need not be named.
  /// Runs where nothing is given and standard output is a terminal, if it is set. Returns the exit code.
  int (*overview)() = nullptr;
  /// Its options can also stand in a TOML file, which --config names. For a program with one verb.
  bool has_config = false;
};

/// The program that runs. Set by run_program().
[[nodiscard]] const program& this_program() noexcept;

/// The words of the command line that run_program() was given, without the program's name.
[[nodiscard]] const std::vector<std::string>& command_line() noexcept;

/// The exit codes and what they mean.
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

/// What SOURCE can be.
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
    {"sim:", "a simulated G4; sim:?world=FILE&seed=N&fault=FAULT"},
}};

/// main() of every program: runs the verb of the command line and reports errors. Returns the exit code.
[[nodiscard]] int run_program(const program& run, int argc, const char* const* argv) noexcept;

/// Reads the command line. Returns the function to run, which returns the exit code; after --help,
/// --version and a wrong command line nothing is left to do, and it only returns that.
[[nodiscard]] std::function<int()> read_command_line(int argc, const char* const* argv);

/// "PROBLEM. See: COMMAND --help".
[[nodiscard]] std::string with_help(const std::string& problem, std::string_view command);

/// `--generate man DIRECTORY`, which the build runs: writes the man pages to the directory. Returns the
/// exit code.
[[nodiscard]] int write_man_pages(const std::string& directory);

/// `--complete WORD...`, which the scripts of the shells run: prints what the last word,
/// which may be empty, can become, each with a tab and what it means; `/` stands for the names of
/// files. Returns the exit code.
[[nodiscard]] int complete(std::span<const std::string> words);

}  // namespace g4_tool
