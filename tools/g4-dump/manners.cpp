// SPDX-License-Identifier: MIT
#include "manners.hpp"

#include <unistd.h>

#include <cstdlib>
#include <string>

#include "say.hpp"
#include "values.hpp"

namespace g4_dump {

manners& our_manners() noexcept {
  static manners ours;
  return ours;
}

std::vector<option_row> manners_rows() {
  const auto set = [](bool manners::* flag) {
    return [flag](const std::string&) { our_manners().*flag = true; };
  };
  std::vector<option_row> rows;
  rows.push_back({.names = "-q,--quiet",
                  .value = "",
                  .help = "Nothing but errors on standard error",
                  .take = set(&manners::quiet)});
  rows.push_back({.names = "-v,--verbose",
                  .value = "",
                  .help = "Tell more of what is done",
                  .take = set(&manners::verbose)});
  rows.push_back({.names = "--color",
                  .value = "auto|always|never",
                  .help = "Colours, where there are any (auto: on a terminal)",
                  .take =
                      [](const std::string& word) {
                        our_manners().color =
                            choice_of<color_choice>(word, {{"auto", color_choice::automatic},
                                                           {"always", color_choice::always},
                                                           {"never", color_choice::never}});
                      },
                  .complete = completion::choices});
  rows.push_back({.names = "--json-errors",
                  .value = "",
                  .help = "What goes wrong as a JSON object, for programs",
                  .take = set(&manners::json_errors)});
  return rows;
}

void tell(std::string_view words) noexcept {
  if (!our_manners().quiet) say(words);
}

void tell_more(std::string_view words) noexcept {
  if (our_manners().verbose) say(words);
}

bool wants_color(int descriptor) noexcept {
  if (our_manners().color != color_choice::automatic) {
    return our_manners().color == color_choice::always;
  }
  const char* const no_color = std::getenv("NO_COLOR");
  const char* const terminal = std::getenv("TERM");
  if (no_color != nullptr && *no_color != '\0') return false;
  if (terminal != nullptr && std::string_view(terminal) == "dumb") return false;
  return ::isatty(descriptor) != 0;
}

}  // namespace g4_dump
