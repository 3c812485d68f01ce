// SPDX-License-Identifier: MIT
// What g4-dump tells the shell, and the one kind of exception by which a command gives up.
#pragma once

#include <stdexcept>
#include <string>

#include "g4lidar/error.hpp"

namespace g4_dump {

/// The exit codes of g4-dump; they do not change. A command that a signal ended exits with 128 + the
/// number of the signal.
enum class exit_code : int {
  ok = 0,
  usage = 2,       ///< The command line makes no sense.
  no_device = 3,   ///< No port, no lidar, or several of them and no word which.
  permission = 4,  ///< This user may not open it.
  busy = 5,        ///< Another program has it.
  silent = 6,      ///< Nothing comes, or nothing that makes sense: a wrong baud rate, most often.
  not_a_g4 = 7,    ///< Something else answers.
  unhealthy = 8,   ///< It says that it is defective, or does not do what it is told.
  lost = 9,        ///< It was there and has gone.
  bad_file = 10,   ///< A file that cannot be read or written, or holds nothing of use.
};

/// The exit code for a problem that has ended a command. `was_running`: points had come before.
[[nodiscard]] exit_code exit_code_for(const g4lidar::error& why, bool was_running = false) noexcept;

/// Why a command gives up: whole sentences that say what is wrong and what to do.
class failure : public std::runtime_error {
 public:
  /// `problem`: as the library calls it, where it is one of its own.
  failure(exit_code code, const std::string& sentences, std::string_view problem = {})
      : std::runtime_error(sentences), code_(code), problem_(problem) {}
  /// As the library says it.
  explicit failure(const g4lidar::error& why, bool was_running = false)
      : std::runtime_error(why.message()),
        code_(exit_code_for(why, was_running)),
        problem_(name_of(why.what())) {}

  [[nodiscard]] exit_code code() const noexcept { return code_; }
  /// The problem's name in docs/errors.md; empty where the library knows nothing of it.
  [[nodiscard]] std::string_view problem() const noexcept { return problem_; }

 private:
  exit_code code_;
  std::string_view problem_;
};

}  // namespace g4_dump
