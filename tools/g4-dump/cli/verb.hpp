// SPDX-License-Identifier: MIT
// The table of verbs and options: the parser, the help, the man page and the completions are made
// from it.
#pragma once

#include <functional>
#include <stdexcept>
#include <string>
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

}  // namespace g4_dump
