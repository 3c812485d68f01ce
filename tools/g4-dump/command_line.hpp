// SPDX-License-Identifier: MIT
// The command line: which verb, with which options.
#pragma once

#include <variant>

#include "decode_command.hpp"
#include "sim_command.hpp"

namespace g4_dump {

/// Everything has been said already (--help, --version, a wrong command line): the exit code.
struct nothing_to_do {
  int code;
};

using command = std::variant<nothing_to_do, decode_options, sim_options>;

/// Reads the command line.
[[nodiscard]] command read_command_line(int argc, const char* const* argv);

}  // namespace g4_dump
