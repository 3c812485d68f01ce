// SPDX-License-Identifier: MIT
// The table of verbs and options: the parser, the help, the man page and the completions are made
// from it.
#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace g4_dump {

/// Thrown by option_row::take and verb::run for a value that makes no sense: what is wrong with it,
/// without the option's name and without a full stop.
class bad_value : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// What a shell offers for a value.
enum class completion : unsigned char { nothing, file, directory, source, choices };

/// One option. It has a value where `value` names one; else it is a flag.
struct option_row {
  std::string names{};                             ///< "-o,--output"
  std::string value{};                             ///< "FILE", "csv|jsonl|text"; empty for a flag.
  std::string help{};                              ///< A line; the default in parentheses.
  std::function<void(const std::string&)> take{};  ///< Of a flag it gets "".
  completion complete = completion::nothing;       ///< choices: the words of `value`.
  bool repeatable = false;                         ///< May be given again.
  std::string group{};                             ///< Its heading in the help; empty: Options.
  std::vector<std::string> needs{};                ///< "--link": makes no sense without.
  std::vector<std::string> excludes{};             ///< Makes no sense with.
};

/// What stands behind the verb without a dash.
struct argument_row {
  std::string name{};  ///< "SOURCE"
  std::string help{};
  std::function<void(const std::string&)> take{};
  completion complete = completion::nothing;
  bool required = false;
  bool repeatable = false;
};

/// One verb. `options` and `arguments` write into what `run` reads, which they share.
struct verb {
  std::string name{};
  std::string summary{};  ///< A line.
  std::vector<argument_row> arguments{};
  std::vector<option_row> options{};
  std::string details{};                ///< Whole paragraphs, in lines of at most 98 characters.
  std::vector<std::string> examples{};  ///< Command lines that can be copied.
  std::vector<int> exits{};             ///< The exit codes that it can have; empty: all.
  std::function<int()> run{};           ///< Returns the exit code; throws a failure.
};

/// `verb` with the options that `more` adds behind its own.
inline void append(std::vector<option_row>& options, std::vector<option_row> more) {
  for (option_row& row : more) options.push_back(std::move(row));
}

}  // namespace g4_dump
