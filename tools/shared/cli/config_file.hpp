// SPDX-License-Identifier: MIT
// The file of --config: its text, and what is wrong with it.
#pragma once

#include <istream>
#include <string>
#include <vector>

namespace g4_tool {

/// The text; with a `problem` if it cannot be read, or is too long.
[[nodiscard]] std::string config_text(std::istream& in, std::string& problem);

/// The error of a line that is not an option.
[[nodiscard]] std::string problem_in_file(std::string line,
                                          const std::vector<std::string>& options);

}  // namespace g4_tool
