// SPDX-License-Identifier: MIT
// The man pages, from the texts of the help and in its order. A program with several commands has an
// overview page, and a page for each command.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common_options.hpp"
#include "exit_code.hpp"
#include "g4lidar/version.hpp"
#include "io/output.hpp"
#include "option_rows.hpp"
#include "verbs.hpp"

namespace g4_tool {
namespace {

/// Escaped for man(7). A dash becomes a minus, so that it can be copied.
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

/// An entry of a list: `title`, already escaped, and its meaning indented below.
std::string entry(const std::string& title, std::string_view meaning) {
  return ".TP\n" + title + "\n" + escaped(meaning) + ".\n";
}

/// The help text, and the options that cannot be used with this one.
std::string meaning_of(const option_row& row, const option_rows& all) {
  std::vector<std::string> excluded = row.excludes;
  for (const option_row& other : all) {
    if (std::ranges::count(other.excludes, row.long_name()) > 0) {
      excluded.push_back(other.long_name());
    }
  }
  if (excluded.empty()) return row.help;
  return fmt::format("{}. Cannot be used with {}", row.help, fmt::join(excluded, ", "));
}

/// Each group under its heading, as in the help.
std::string options_of(const option_rows& rows) {
  std::vector<std::pair<std::string, std::string>> groups;
  for (const option_row& row : rows) {
    auto at = std::ranges::find(groups, row.group, &std::pair<std::string, std::string>::first);
    if (at == groups.end()) at = groups.insert(groups.end(), {row.group, {}});
    at->second += entry(title_of(row), meaning_of(row, rows));
  }
  std::string text;
  for (const auto& [heading, entries] : groups) {
    text += (heading.empty() ? "" : ".SS " + escaped(heading) + "\n") + entries;
  }
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

/// A table of the rows "  name  meaning". Lines with a deeper indent continue the row above.
std::string table(const std::vector<std::string_view>& lines) {
  constexpr std::size_t indent = 2;
  constexpr std::size_t widest = 20;
  std::vector<std::pair<std::string_view, std::string>> rows;
  std::size_t width = 0;
  for (std::string_view line : lines) {
    const std::size_t begin = line.find_first_not_of(' ');
    line.remove_prefix(begin);
    if (begin > indent && !rows.empty()) {
      rows.back().second += "\n" + escaped(line);
      continue;
    }
    const std::size_t end = std::min(line.find("  "), line.size());
    const std::size_t meaning = std::min(line.find_first_not_of(' ', end), line.size());
    rows.emplace_back(line.substr(0, end), escaped(line.substr(meaning)));
    if (end + indent <= widest) width = std::max(width, end + indent);
  }
  std::string text = ".PD 0\n";
  for (const auto& [name, meaning] : rows) {
    text += fmt::format(".TP {}\n\\fB{}\\fR\n{}\n", width, escaped(name), meaning);
  }
  return text + ".PD\n";
}

/// Paragraphs, which empty lines separate. Indented lines are the rows of a table.
std::string paragraphs(std::string_view text) {
  std::string out;
  std::vector<std::string_view> rows;
  bool is_new = true;
  const auto begin_paragraph = [&out] { out += out.empty() ? "" : ".PP\n"; };
  const auto end_table = [&] {
    if (rows.empty()) return;
    begin_paragraph();
    out += table(std::exchange(rows, {}));
  };
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.starts_with(' ')) {
      rows.push_back(line);
      continue;
    }
    end_table();
    if (!line.empty() && is_new) begin_paragraph();
    if (!line.empty()) out += escaped(line) + "\n";
    is_new = line.empty();
  }
  end_table();
  return out;
}

std::string exit_status_of(const std::vector<int>& wanted) {
  std::string text = ".SH \"EXIT STATUS\"\n";
  for (const auto& [code, meaning] : exit_code_rows(wanted)) {
    text += entry(fmt::format(".B {}", code), meaning);
  }
  return text;
}

std::string examples_of(const verb& shown) {
  std::string text = shown.examples.empty() ? "" : ".SH EXAMPLES\n";
  for (const example& each : shown.examples) {
    text += entry("\\fB" + escaped(each.line) + "\\fR", each.words);
  }
  return text;
}

/// "g4-dump-scan" in bold, and (1).
std::string reference_to(std::string_view page) { return ".BR " + escaped(page) + " (1)"; }

std::string see_also(const std::vector<std::string>& pages) {
  std::string text = ".SH \"SEE ALSO\"\n";
  for (const std::string& page : pages) {
    text += reference_to(page) + (page == pages.back() ? "\n" : ",\n");
  }
  return text;
}

std::string page_of(const program& ours, const verb& shown) {
  return fmt::format("{}-{}", ours.name, shown.name);
}

/// The programs of this project.
constexpr std::array<std::string_view, 3> programs{"g4-dump", "g4-ros2", "g4-serve"};

/// The pages of the program, of the commands that the text names, and of the program that the
/// command runs.
std::vector<std::string> related_pages(const program& ours, const verb& shown) {
  std::vector<std::string> pages{std::string(ours.name)};
  for (const verb& other : ours.verbs()) {
    const std::string words = fmt::format("{} {}", ours.name, other.name);
    if (other.name != shown.name && shown.details.find(words) != std::string::npos) {
      pages.push_back(page_of(ours, other));
    }
  }
  const std::string run = "g4-" + shown.name;
  if (std::ranges::find(programs, run) != programs.end()) pages.push_back(run);
  return pages;
}

std::vector<std::string> related_programs(const program& ours) {
  std::vector<std::string> pages;
  for (const std::string_view name : programs) {
    if (name != ours.name) pages.emplace_back(name);
  }
  return pages;
}

/// A page up to the heading of its description.
std::string head_of(std::string_view page, std::string_view title, const std::string& synopsis) {
  std::string upper = escaped(page);
  std::ranges::transform(upper, upper.begin(),
                         [](char c) { return static_cast<char>(std::toupper(c)); });
  return fmt::format(
      ".TH {} 1 2026-11-23 \"{} {}.{}.{}\" \"User Commands\"\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n{}"
      ".SH DESCRIPTION\n",
      upper, escaped(this_program().name), G4LIDAR_VERSION_MAJOR, G4LIDAR_VERSION_MINOR,
      G4LIDAR_VERSION_PATCH, escaped(page), escaped(title), synopsis);
}

std::string sources() {
  std::string text = ".SH SOURCES\n";
  for (const source_form& each : source_forms) {
    text += entry("\\fI" + escaped(each.form) + "\\fR", each.meaning);
  }
  return text;
}

/// The last sections of the page of a program.
std::string environment_and_bugs() {
  std::string text = ".SH ENVIRONMENT\n";
  text += entry(".B NO_COLOR", "If it is set and not empty, the output is not colored");
  text += entry(".B G4LIDAR_SIM_DIR",
                "A directory of simulated lidars, which are then discovered as serial ports. "
                "See g4-dump sim --register");
  return text + ".SH \"REPORTING BUGS\"\n" +
         escaped("Attach the two files of g4-dump doctor --report report.txt to a report at " +
                 std::string(G4LIDAR_ISSUES) + ".") +
         "\n";
}

/// The page of one of several commands.
std::string command_page(const program& ours, const verb& shown) {
  std::string text = head_of(page_of(ours, shown), shown.summary, synopsis_of(shown));
  text += escaped(shown.summary) + ".\n";
  if (!shown.details.empty()) text += ".PP\n" + paragraphs(shown.details);
  text += ".SH OPTIONS\n" + options_of(shown.arguments) + options_of(shown.options);
  text += ".SS Options of every command\n";
  const option_rows shared = joined(global_rows(), standard_rows());
  for (const option_row& row : shared) {
    text += "\\fB" + escaped(row.long_name());
    text += &row == &shared.back() ? "\\fR: see\n" : "\\fR,\n";
  }
  text += reference_to(ours.name) +
          ".\nIt also describes the forms of\n.I SOURCE\nand the environment variables.\n";
  return text + exit_status_of(shown.exits) + examples_of(shown) +
         see_also(related_pages(ours, shown));
}

/// The page of a program with several commands.
std::string overview_page(const program& ours) {
  const std::vector<verb> verbs = ours.verbs();
  const std::string name = escaped(ours.name);
  std::string text =
      head_of(ours.name, ours.title,
              fmt::format(".B {}\n.RI [ COMMAND \"] [\" OPTIONS \"] [\" SOURCE ]\n", name));
  text += paragraphs(ours.description) + ".SH COMMANDS\n";
  text += fmt::format(
      "Each command has a page of its own: man {0}\\-{1}.\n.B {0} {1} \\-\\-help\n"
      "prints its options.\n",
      name, escaped(verbs.front().name));
  for (const verb& each : verbs) text += entry(reference_to(page_of(ours, each)), each.summary);
  text += ".SH OPTIONS\nOptions of every command:\n";
  text += options_of(joined(global_rows(), standard_rows())) + sources() + exit_status_of({});
  const auto by_default = std::ranges::find(verbs, ours.default_verb, &verb::name);
  if (by_default != verbs.end()) text += examples_of(*by_default);
  return text + environment_and_bugs() + see_also(related_programs(ours));
}

/// The page of a program with one command.
std::string single_page(const program& ours, const verb& only) {
  std::string text = head_of(ours.name, ours.title, synopsis_of(only));
  text += paragraphs(ours.description) + sources() + ".SH OPTIONS\n";
  text += options_of(joined(only.options, global_rows(), standard_rows()));
  if (!only.details.empty()) text += ".SH NOTES\n" + paragraphs(only.details);
  return text + exit_status_of({}) + examples_of(only) + environment_and_bugs() +
         see_also(related_programs(ours));
}

void write(const std::string& directory, std::string_view page, std::string_view text) {
  allow_replacing();
  output out(fmt::format("{}/{}.1", directory, page));
  out.write(text);
  out.commit();
}

}  // namespace

int write_man_pages(const std::string& directory) {
  const program& ours = this_program();
  const std::vector<verb> verbs = ours.verbs();
  const bool is_single = verbs.size() == 1;
  write(directory, ours.name, is_single ? single_page(ours, verbs.front()) : overview_page(ours));
  if (is_single) return static_cast<int>(exit_code::ok);
  for (const verb& each : verbs) write(directory, page_of(ours, each), command_page(ours, each));
  return static_cast<int>(exit_code::ok);
}

}  // namespace g4_tool
