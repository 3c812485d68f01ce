// SPDX-License-Identifier: MIT
// What g4-dump tells the shell, and the one kind of exception by which a command gives up.
#pragma once

#include <stdexcept>
#include <string>

namespace g4_dump {

/// The exit codes of g4-dump; they do not change. 3 to 9 belong to the commands that talk to a
/// device. A command that a signal ended exits with 128 + the number of the signal.
enum class exit_code : int {
  ok = 0,
  usage = 2,      ///< The command line makes no sense.
  bad_file = 10,  ///< A file that cannot be read or written, or holds nothing of use.
};

/// Why a command gives up: whole sentences that say what is wrong and what to do.
class failure : public std::runtime_error {
 public:
  failure(exit_code code, const std::string& sentences)
      : std::runtime_error(sentences), code_(code) {}

  [[nodiscard]] exit_code code() const noexcept { return code_; }

 private:
  exit_code code_;
};

}  // namespace g4_dump
