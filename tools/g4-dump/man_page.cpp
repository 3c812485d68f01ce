// SPDX-License-Identifier: MIT
// The man page: the help's words, in the order of the help.
#include <fmt/format.h>

#include <string>
#include <string_view>

#include "g4lidar/version.hpp"
#include "manners.hpp"
#include "manual.hpp"
#include "verbs.hpp"

namespace g4_dump {
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

/// "-o, --output OUT" with the names in bold and the value in italics.
std::string title_of(const option_row& row) {
  std::string names;
  for (const char c : row.names) names += c == ',' ? std::string("\\fR, \\fB") : escaped({&c, 1});
  std::string title = "\\fB" + names + "\\fR";
  if (!row.value.empty()) title += " \\fI" + escaped(row.value) + "\\fR";
  return title;
}

std::string options_of(const std::vector<option_row>& rows) {
  std::string text;
  for (const option_row& row : rows) {
    text += ".TP\n" + title_of(row) + "\n" + escaped(row.help) + ".\n";
  }
  return text;
}

std::string synopsis_of(const verb& shown) {
  std::string text = ".B g4\\-dump " + escaped(shown.name) + "\n";
  if (!shown.options.empty()) text += ".RI [ OPTIONS ]\n";
  for (const argument_row& row : shown.arguments) {
    const std::string more = row.repeatable ? "..." : "";
    text += row.required ? ".I " + escaped(row.name) + more + "\n"
                         : ".RI [ " + escaped(row.name) + " ]" + more + "\n";
  }
  return text;
}

std::string paragraphs(const std::string& text) {
  std::string out;
  std::string paragraph;
  const auto end = [&] {
    if (!paragraph.empty()) out += (out.empty() ? "" : ".PP\n") + escaped(paragraph);
    paragraph.clear();
  };
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t line_end = std::min(text.find('\n', at), text.size());
    const std::string line = text.substr(at, line_end - at);
    at = line_end + 1;
    if (line.empty()) {
      end();
    } else {
      paragraph += line + "\n";
    }
  }
  end();
  return out;
}

std::string section_of(const verb& shown) {
  std::string text = ".SS " + escaped(shown.name) + "\n" + escaped(shown.summary) + ".\n.PP\n";
  text += synopsis_of(shown);
  for (const argument_row& row : shown.arguments) {
    text += ".TP\n\\fI" + escaped(row.name) + "\\fR\n" + escaped(row.help) + ".\n";
  }
  text += options_of(shown.options);
  return text + (shown.details.empty() ? "" : ".PP\n") + paragraphs(shown.details);
}

std::string examples_of(const std::vector<verb>& verbs) {
  std::string text = ".SH EXAMPLES\n.nf\n";
  for (const verb& each : verbs) {
    for (const std::string& line : each.examples) text += escaped(line) + "\n";
  }
  return text + ".fi\n";
}

std::string exits() {
  std::string text = ".SH \"EXIT STATUS\"\n";
  for (const exit_code_row& row : exit_codes()) {
    text += fmt::format(".TP\n.B {}\n{}\n", row.code, escaped(row.meaning));
  }
  return text;
}

constexpr std::string_view description =
    R"(The console tool for the YDLIDAR G4, a 360-degree scanning lidar on a serial line. Without a verb it
prints points, and without a source it takes the only G4 that is plugged in.

Data goes to standard output, words to standard error. No question is ever asked, and no setting of
the device is changed but by the verb set.
)";

constexpr std::string_view sources =
    R"(.TP
.I /dev/ttyUSB0
A serial port.
.TP
.I serial:2021101000070073
The lidar with this number of its own, behind whatever port.
.TP
.I usb:1\-1.4
The port at this USB place.
.TP
.I tcp:HOST:PORT
A network bridge that passes raw bytes on.
.TP
.I FILE
A recording, or raw bytes as they came from a port.
.TP
.I \-
Raw bytes from standard input.
.TP
.I sim:
A simulated G4; sim:?world=FILE&seed=N&fault=FAULT says more. More than one fault may be given.
)";

}  // namespace

std::string man_page() {
  const std::vector<verb> verbs = all_verbs();
  std::string text =
      fmt::format(".TH G4\\-DUMP 1 2026-11-21 \"g4\\-dump {}.{}.{}\" \"User Commands\"\n",
                  G4LIDAR_VERSION_MAJOR, G4LIDAR_VERSION_MINOR, G4LIDAR_VERSION_PATCH);
  text += ".SH NAME\ng4\\-dump \\- console tool for the YDLIDAR G4\n.SH SYNOPSIS\n";
  text += ".B g4\\-dump\n.RI [ VERB \"] [\" OPTIONS \"] [\" SOURCE ]\n";
  text += ".SH DESCRIPTION\n" + paragraphs(std::string(description));
  text += ".SH SOURCES\n" + std::string(sources);
  text += ".SH OPTIONS\nOf every verb:\n" + options_of(manners_rows());
  text += ".TP\n\\fB\\-h\\fR, \\fB\\-\\-help\\fR\nPrint a help message and exit.\n";
  text += ".TP\n\\fB\\-\\-version\\fR\nPrint the version and exit.\n";
  text += ".SH VERBS\n";
  for (const verb& each : verbs) text += section_of(each);
  text += exits() + examples_of(verbs);
  text +=
      ".SH ENVIRONMENT\n.TP\n.B NO_COLOR\nWhere it is set and not empty, nothing is coloured.\n";
  return text;
}

}  // namespace g4_dump
