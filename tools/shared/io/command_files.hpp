// SPDX-License-Identifier: MIT
// The files of the command that runs: nothing that it writes, replaces or removes is among those that it reads.
#pragma once

#include <string>

namespace g4_tool {

/// The command reads what this word names: a file or a source, also as NAME=SOURCE. Each row of the table of
/// options whose completion is `input` or `source` does that by itself. Standard input counts always.
void add_input(const std::string& word);
/// The word is an output: takes one add_input() back.
void take_back_input(const std::string& word);

/// --force was given: existing files may be replaced.
void allow_replacing() noexcept;
[[nodiscard]] bool may_replace() noexcept;

/// A file that the command writes, as long as this exists. Every output has one: `output` and `record()` do.
class claimed_output {
 public:
  /// `name`: `-` is standard output. Throws a failure if it is one of the inputs, under any name, or another output of the
  /// command, and if it exists and may not be replaced. What is not on disk, as a pipe or a device, is not checked.
  explicit claimed_output(std::string name);
  claimed_output(const claimed_output&) = delete;
  claimed_output& operator=(const claimed_output&) = delete;
  ~claimed_output();

  /// For use directly before the file is replaced. Throws a failure if it is one of the inputs.
  void refuse_inputs() const;

 private:
  std::string name_;
};

}  // namespace g4_tool
