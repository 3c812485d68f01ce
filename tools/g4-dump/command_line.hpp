// SPDX-License-Identifier: MIT
// The command line: which verb, with which options.
#pragma once

#include <functional>

namespace g4_dump {

/// Reads the command line; what is to be run then, which returns the exit code. Where everything has
/// been said already (--help, --version, a wrong command line), it only does that.
[[nodiscard]] std::function<int()> read_command_line(int argc, const char* const* argv);

}  // namespace g4_dump
