// SPDX-License-Identifier: MIT
// The global options, which every verb has.
#pragma once

#include "verb.hpp"

namespace g4_dump {

enum class color_choice : unsigned char { automatic, always, never };

/// Set once, by the command line.
struct global_options {
  bool quiet = false;    ///< Only errors on standard error.
  bool verbose = false;  ///< Messages about each step.
  bool json_errors = false;
  color_choice color = color_choice::automatic;
};

[[nodiscard]] global_options& our_global_options() noexcept;

/// -q, -v, --color, --json-errors.
[[nodiscard]] option_rows global_rows();

/// Whether what is written to `descriptor` is to be coloured: a terminal, no NO_COLOR, or --color.
[[nodiscard]] bool wants_color(int descriptor) noexcept;

}  // namespace g4_dump
