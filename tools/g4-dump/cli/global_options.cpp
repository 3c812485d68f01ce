// SPDX-License-Identifier: MIT
#include "global_options.hpp"

#include <unistd.h>

#include <cstdlib>
#include <string_view>

#include "rows.hpp"

namespace g4_dump {

global_options& our_global_options() noexcept {
  static global_options ours;
  return ours;
}

option_rows global_rows() {
  global_options& ours = our_global_options();
  return {flag_row("-q,--quiet", "Write only errors to standard error", ours.quiet),
          flag_row("-v,--verbose", "Write messages about each step", ours.verbose),
          choice_row("--color", "When to color the output (auto: on a terminal)", ours.color,
                     choices<color_choice>{{"auto", color_choice::automatic},
                                           {"always", color_choice::always},
                                           {"never", color_choice::never}}),
          flag_row("--json-errors", "Write an error as a JSON object", ours.json_errors)};
}

bool wants_color(int descriptor) noexcept {
  if (our_global_options().color != color_choice::automatic) {
    return our_global_options().color == color_choice::always;
  }
  const char* const no_color = std::getenv("NO_COLOR");
  const char* const terminal = std::getenv("TERM");
  if (no_color != nullptr && *no_color != '\0') return false;
  if (terminal != nullptr && std::string_view(terminal) == "dumb") return false;
  return ::isatty(descriptor) != 0;
}

}  // namespace g4_dump
