// SPDX-License-Identifier: MIT
// What went wrong, on standard error: a line for people, or a JSON object for programs.
#pragma once

#include <string>
#include <string_view>

#include "exit_code.hpp"

namespace g4_dump {

/// "g4-dump: SENTENCES", or with --json-errors {"error":SENTENCES,"problem":...,"exit_code":N}.
void report(std::string_view sentences, exit_code code, std::string_view problem = {});

}  // namespace g4_dump
