// SPDX-License-Identifier: MIT
// The report of a problem, for people who help, in two files: a text, and a recording beside it.
#pragma once

#include <string>
#include <string_view>

#include "cli/common_options.hpp"
#include "io/output.hpp"

namespace g4_tool {

class problem_report {
 public:
  /// Writes the versions, the system and the ports to the text `path`. Throws bad_value for an unsuitable name, and a
  /// failure if a file exists already or cannot be created.
  problem_report(const common_options& source, const std::string& path);

  /// Adds a part of the diagnosis.
  void add(std::string_view text) { text_.write(text); }
  /// Adds the settings and the counts of ten recorded seconds, or why they are missing, and logs the names of the
  /// files.
  void finish();

 private:
  const common_options source_;
  output text_;
  const bool is_recorded_;       // a file is not
  const std::string recording_;  // beside the text, or the file that is examined
};

}  // namespace g4_tool
