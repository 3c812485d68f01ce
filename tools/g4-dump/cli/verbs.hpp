// SPDX-License-Identifier: MIT
// The table of verbs and options, and what the help contains beside them: the command line, the man
// page and the completions are made from it. Each verb is made in verbs/.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace g4_dump {

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

[[nodiscard]] verb make_list_verb();
[[nodiscard]] verb make_watch_verb();
[[nodiscard]] verb make_info_verb();
[[nodiscard]] verb make_health_verb();
[[nodiscard]] verb make_stats_verb();
[[nodiscard]] verb make_dump_verb();
[[nodiscard]] verb make_scan_verb();
[[nodiscard]] verb make_doctor_verb();
[[nodiscard]] verb make_packets_verb();
[[nodiscard]] verb make_decode_verb();
[[nodiscard]] verb make_sim_verb();
[[nodiscard]] verb make_set_verb();
[[nodiscard]] verb make_start_verb();
[[nodiscard]] verb make_stop_verb();
[[nodiscard]] verb make_restart_verb();
[[nodiscard]] verb make_record_verb();
[[nodiscard]] verb make_replay_verb();
[[nodiscard]] verb make_convert_verb();

/// All of them, in the order of the help.
[[nodiscard]] std::vector<verb> all_verbs();

/// The verb that need not be named.
inline constexpr std::string_view default_verb = "dump";

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

/// Reads the command line. Returns the function to run, which returns the exit code; after --help,
/// --version and a wrong command line nothing is left to do, and it only returns that.
[[nodiscard]] std::function<int()> read_command_line(int argc, const char* const* argv);

/// `g4-dump --generate man`, which the build runs: prints g4-dump(1). Returns the exit code.
[[nodiscard]] int print_man_page();

/// `g4-dump --complete WORD...`, which the scripts of the shells run: prints what the last word,
/// which may be empty, can become, each with a tab and what it means; `/` stands for the names of
/// files. Returns the exit code.
[[nodiscard]] int complete(std::span<const std::string> words);

}  // namespace g4_dump
