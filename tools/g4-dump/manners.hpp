// SPDX-License-Identifier: MIT
// How the whole program speaks: the options that every verb has.
#pragma once

#include <string_view>
#include <vector>

#include "verb.hpp"

namespace g4_dump {

enum class color_choice : unsigned char { automatic, always, never };

/// Set once, by the command line.
struct manners {
  bool quiet = false;    ///< Nothing but errors on standard error.
  bool verbose = false;  ///< More of what is being done.
  bool json_errors = false;
  color_choice color = color_choice::automatic;
};

[[nodiscard]] manners& our_manners() noexcept;

/// -q, -v, --color, --json-errors.
[[nodiscard]] std::vector<option_row> manners_rows();

/// Words for people on standard error, but with -q not.
void tell(std::string_view words) noexcept;
/// The same with -v only.
void tell_more(std::string_view words) noexcept;

/// Whether what is written to `descriptor` is to be coloured: a terminal, no NO_COLOR, or --color.
[[nodiscard]] bool wants_color(int descriptor) noexcept;

}  // namespace g4_dump
