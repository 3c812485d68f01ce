// SPDX-License-Identifier: MIT
// The man page: the help's words, in the order of the help.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "common_options.hpp"
#include "exit_code.hpp"
#include "g4lidar/version.hpp"
#include "rows.hpp"
#include "verbs.hpp"

namespace g4_tool {
namespace {

/// As man(7) wants text: a dash is a minus, which can be copied.
std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const bool begins_line = out.empty() || out.back() == '\n';
    if (begins_line && (c == '.' || c == '\'')) out += "\\&";
    if (c == '-') {
      out += "\\-";
    } else if (c == '\\') {
      out += "\\e";
    } else {
      out += c;
    }
  }
  return out;
}

/// "-o, --output OUT" with the names in bold and the value in italics; "SOURCE" in italics.
std::string title_of(const option_row& row) {
  if (!row.names.starts_with('-')) return "\\fI" + escaped(row.names) + "\\fR";
  std::string names;
  for (const char c : row.names) names += c == ',' ? std::string("\\fR, \\fB") : escaped({&c, 1});
  std::string title = "\\fB" + names + "\\fR";
  if (!row.optional_value.empty()) title += "[=\\fI" + escaped(row.optional_value) + "\\fR]";
  if (!row.value.empty()) title += " \\fI" + escaped(row.value) + "\\fR";
  return title;
}

/// A title, which is as man(7) wants it, and indented under it what it means.
std::string entry(const std::string& title, std::string_view meaning) {
  return ".TP\n" + title + "\n" + escaped(meaning) + ".\n";
}

std::string options_of(const option_rows& rows) {
  std::string text;
  for (const option_row& row : rows) text += entry(title_of(row), row.help);
  return text;
}

std::string synopsis_of(const verb& shown) {
  const std::string_view ours = this_program().name;
  std::string text =
      ".B " + escaped(ours) + (shown.name == ours ? "" : " " + escaped(shown.name)) + "\n";
  if (!shown.options.empty()) text += ".RI [ OPTIONS ]\n";
  for (const option_row& row : shown.arguments) {
    const std::string more = row.repeatable ? "..." : "";
    text += row.required ? ".I " + escaped(row.names) + more + "\n"
                         : ".RI [ " + escaped(row.names) + " ]" + more + "\n";
  }
  return text;
}

/// Paragraphs; indented lines are a table, which stays as it is.
std::string paragraphs(std::string_view text) {
  std::string out;
  bool in_table = false;
  bool is_new = true;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const bool is_row = line.starts_with(' ');
    if (in_table && !is_row) out += ".fi\n";
    if (!in_table && is_row) out += ".PP\n.nf\n";
    if (!is_row && !line.empty() && (is_new || in_table)) out += out.empty() ? "" : ".PP\n";
    in_table = is_row;
    is_new = line.empty();
    if (!line.empty()) out += escaped(line) + "\n";
  }
  return out + (in_table ? ".fi\n" : "");
}

std::string section_of(const verb& shown) {
  std::string text = ".SS " + escaped(shown.name) + "\n" + escaped(shown.summary) + ".\n.PP\n";
  text += synopsis_of(shown);
  text += options_of(shown.arguments) + options_of(shown.options);
  return text + (shown.details.empty() ? "" : ".PP\n") + paragraphs(shown.details);
}

/// In the language of man(7).
std::string man_page() {
  const program& ours = this_program();
  const std::vector<verb> verbs = ours.verbs();
  const bool is_single = verbs.size() == 1;
  const std::string name = escaped(ours.name);
  std::string upper = name;
  std::ranges::transform(upper, upper.begin(),
                         [](char c) { return static_cast<char>(std::toupper(c)); });
  std::string text =
      fmt::format(".TH {} 1 2026-11-23 \"{} {}.{}.{}\" \"User Commands\"\n", upper, name,
                  G4LIDAR_VERSION_MAJOR, G4LIDAR_VERSION_MINOR, G4LIDAR_VERSION_PATCH);
  text += fmt::format(".SH NAME\n{} \\- {}\n.SH SYNOPSIS\n", name, escaped(ours.title));
  text += is_single ? synopsis_of(verbs.front())
                    : fmt::format(".B {}\n.RI [ VERB \"] [\" OPTIONS \"] [\" SOURCE ]\n", name);
  text += ".SH DESCRIPTION\n" + paragraphs(ours.description);
  text += ".SH SOURCES\n";
  for (const source_form& each : source_forms) {
    text += entry("\\fI" + escaped(each.form) + "\\fR", each.meaning);
  }
  if (is_single) {
    const verb& only = verbs.front();
    text += ".SH OPTIONS\n" + options_of(joined(only.options, global_rows(), standard_rows()));
    if (!only.details.empty()) text += ".SH NOTES\n" + paragraphs(only.details);
  } else {
    text += ".SH OPTIONS\nOptions of every command:\n";
    text += options_of(joined(global_rows(), standard_rows()));
    text += ".SH COMMANDS\n";
    for (const verb& each : verbs) text += section_of(each);
  }
  text += ".SH \"EXIT STATUS\"\n";
  for (const exit_code_row& row : exit_codes) {
    text += entry(fmt::format(".B {}", row.code), row.meaning);
  }
  text += ".SH EXAMPLES\n";
  for (const verb& each : verbs) {
    for (const example& shown : each.examples) {
      text += entry("\\fB" + escaped(shown.line) + "\\fR", shown.words);
    }
  }
  text += ".SH ENVIRONMENT\n";
  text += entry(".B NO_COLOR", "If it is set and not empty, the output is not colored");
  text += entry(".B G4LIDAR_SIM_DIR",
                "A directory of simulated lidars, which are then discovered as serial ports. "
                "See g4-dump sim --register");
  return text;
}

}  // namespace

int print_man_page() {
  const std::string text = man_page();
  const bool good =
      std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  return static_cast<int>(good ? exit_code::ok : exit_code::bad_file);
}

}  // namespace g4_tool
