// SPDX-License-Identifier: MIT
// Completions for bash, zsh and fish out of the table of verbs.
#include <fmt/format.h>

#include <cstdio>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "exit_code.hpp"
#include "manners.hpp"
#include "manual.hpp"
#include "report.hpp"
#include "verbs.hpp"

namespace g4_dump {
namespace {

std::vector<std::string> pieces_of(const std::string& text, char between) {
  std::vector<std::string> pieces(1);
  for (const char c : text) {
    if (c == between) {
      pieces.emplace_back();
    } else {
      pieces.back() += c;
    }
  }
  return pieces;
}

std::string joined(const std::vector<std::string>& words, std::string_view between) {
  std::string text;
  for (const std::string& word : words) text.append(text.empty() ? "" : between).append(word);
  return text;
}

/// The options of a verb and those that every verb has.
std::vector<option_row> all_options(const verb& of) {
  std::vector<option_row> rows = of.options;
  append(rows, manners_rows());
  rows.push_back({.names = "-h,--help", .help = "Print a help message and exit"});
  return rows;
}

std::vector<std::string> names_of_verbs(const std::vector<verb>& verbs) {
  std::vector<std::string> names;
  names.reserve(verbs.size());
  for (const verb& each : verbs) names.push_back(each.name);
  return names;
}

// ---- bash ---------------------------------------------------------------------------------------

/// What sets COMPREPLY for a value.
std::string bash_offer(completion what, const std::string& choices) {
  switch (what) {
    case completion::choices:
      return fmt::format("COMPREPLY=($(compgen -W '{}' -- \"$cur\"))",
                         joined(pieces_of(choices, '|'), " "));
    case completion::file:
      return "COMPREPLY=($(compgen -f -- \"$cur\"))";
    case completion::directory:
      return "COMPREPLY=($(compgen -d -- \"$cur\"))";
    case completion::source:
      return "_g4_dump_source";
    case completion::nothing:
      break;
  }
  return "COMPREPLY=()";
}

std::string bash_verb(const verb& of) {
  std::string cases;
  std::vector<std::string> names;
  for (const option_row& row : all_options(of)) {
    const std::vector<std::string> own = pieces_of(row.names, ',');
    names.insert(names.end(), own.begin(), own.end());
    if (row.value.empty()) continue;
    cases += fmt::format("        {}) {}; return ;;\n", joined(own, "|"),
                         bash_offer(row.complete, row.value));
  }
  const std::string behind =
      of.arguments.empty() ? "COMPREPLY=()" : bash_offer(of.arguments.front().complete, "");
  return fmt::format(
      "    {})\n      case $prev in\n{}      esac\n"
      "      if [[ $cur == -* ]]; then COMPREPLY=($(compgen -W '{}' -- \"$cur\"))\n"
      "      else {}; fi ;;\n",
      of.name, cases, joined(names, " "), behind);
}

// ---- zsh ----------------------------------------------------------------------------------------

/// Inside single quotes and brackets of _arguments.
std::string zsh_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\'') {
      out += "'\\''";
    } else if (c == ':' || c == '[' || c == ']') {
      out += {'\\', c};
    } else {
      out += c;
    }
  }
  return out;
}

std::string zsh_action(completion what, const std::string& choices) {
  switch (what) {
    case completion::choices:
      return "(" + joined(pieces_of(choices, '|'), " ") + ")";
    case completion::file:
      return "_files";
    case completion::directory:
      return "_files -/";
    case completion::source:
      return "_g4_dump_source";
    case completion::nothing:
      break;
  }
  return " ";
}

std::string zsh_verb(const verb& of) {
  std::string text = fmt::format("        {})\n          _arguments", of.name);
  for (const option_row& row : all_options(of)) {
    const std::vector<std::string> names = pieces_of(row.names, ',');
    const std::string value =
        row.value.empty() ? ""
                          : ":" + zsh_text(row.value) + ":" + zsh_action(row.complete, row.value);
    for (const std::string& name : names) {
      const std::string others = row.repeatable ? "*" : "(" + joined(names, " ") + ")";
      text += fmt::format(" \\\n            '{}{}[{}]{}'", others, name, zsh_text(row.help), value);
    }
  }
  for (const argument_row& row : of.arguments) {
    text += fmt::format(" \\\n            '{}:{}:{}'", row.repeatable ? "*" : "",
                        zsh_text(row.name), zsh_action(row.complete, ""));
  }
  return text + " ;;\n";
}

// ---- fish ---------------------------------------------------------------------------------------

std::string fish_text(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') out += '\\';
    out += c;
  }
  return out + "'";
}

std::string fish_value(completion what, const std::string& choices) {
  switch (what) {
    case completion::choices:
      return " -x -a " + fish_text(joined(pieces_of(choices, '|'), " "));
    case completion::file:
      return " -r -F";
    case completion::directory:
      return " -x -a '(__fish_complete_directories)'";
    case completion::source:
      return " -r -F -a '(__g4_dump_sources)'";
    case completion::nothing:
      break;
  }
  return " -x";
}

std::string fish_option(const std::string& condition, const option_row& row) {
  std::string text = "complete -c g4-dump -n " + fish_text(condition);
  for (const std::string& name : pieces_of(row.names, ',')) {
    text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  }
  if (!row.value.empty()) text += fish_value(row.complete, row.value);
  return text + " -d " + fish_text(row.help) + "\n";
}

}  // namespace

std::string bash_completion() {
  const std::vector<verb> verbs = all_verbs();
  std::string text = R"(# Completion of g4-dump for bash, made from its table of options.
# shellcheck shell=bash disable=SC2207

_g4_dump_source() {
  COMPREPLY=($(compgen -W 'sim:' -- "$cur") $(compgen -f -- "$cur"))
  if [[ -z $cur ]]; then COMPREPLY+=($(compgen -G '/dev/ttyUSB*')); fi
}

_g4_dump() {
  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]} verb='' word
  COMPREPLY=()
  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    if [[ $word != -* ]]; then verb=$word; break; fi
  done
  case $verb in
)";
  for (const verb& each : verbs) text += bash_verb(each);
  text += fmt::format(R"(    *)
      if [[ $cur == -* ]]; then COMPREPLY=($(compgen -W '-h --help --version' -- "$cur"))
      else COMPREPLY=($(compgen -W '{}' -- "$cur")); fi ;;
  esac
}}

complete -o filenames -F _g4_dump g4-dump
)",
                      joined(names_of_verbs(verbs), " "));
  return text;
}

std::string zsh_completion() {
  std::string text = R"(#compdef g4-dump
# Completion of g4-dump for zsh, made from its table of options.

_g4_dump_source() {
  local -a ports
  ports=(/dev/ttyUSB*(N) sim:)
  _alternative 'ports:port:compadd -a ports' 'files:file:_files'
}

_g4_dump() {
  local context state state_descr line
  typeset -A opt_args
  _arguments -C '1:verb:->verb' '*::argument:->argument'
  case $state in
    verb)
      local -a verbs
      verbs=(
)";
  const std::vector<verb> verbs = all_verbs();
  for (const verb& each : verbs) {
    text += fmt::format("        '{}:{}'\n", each.name, zsh_text(each.summary));
  }
  text += R"(      )
      _describe verb verbs ;;
    argument)
      case $words[1] in
)";
  for (const verb& each : verbs) text += zsh_verb(each);
  return text + R"(      esac ;;
  esac
}

_g4_dump "$@"
)";
}

std::string fish_completion() {
  const std::vector<verb> verbs = all_verbs();
  const std::string none = "not __fish_seen_subcommand_from " + joined(names_of_verbs(verbs), " ");
  std::string text = R"(# Completion of g4-dump for fish, made from its table of options.

function __g4_dump_sources
    for port in /dev/ttyUSB*
        echo $port
    end
    echo sim:
end

complete -c g4-dump -f
)";
  text += fish_option(none, {.names = "-h,--help", .help = "Print a help message and exit"});
  text += fish_option(none, {.names = "--version", .help = "Print the version and exit"});
  for (const verb& each : verbs) {
    text += fmt::format("complete -c g4-dump -n {} -a {} -d {}\n", fish_text(none), each.name,
                        fish_text(each.summary));
    const std::string seen = "__fish_seen_subcommand_from " + each.name;
    for (const option_row& row : all_options(each)) text += fish_option(seen, row);
    if (each.arguments.empty()) continue;
    const completion what = each.arguments.front().complete;
    if (what == completion::nothing) continue;
    const std::string extra = what == completion::source ? " -a '(__g4_dump_sources)'" : "";
    text += fmt::format("complete -c g4-dump -n {} -F{}\n", fish_text(seen), extra);
  }
  return text;
}

int generate(std::string_view what) {
  const std::map<std::string_view, std::function<std::string()>> makers{{"man", man_page},
                                                                        {"bash", bash_completion},
                                                                        {"zsh", zsh_completion},
                                                                        {"fish", fish_completion}};
  const auto maker = makers.find(what);
  if (maker == makers.end()) {
    report("--generate takes man, bash, zsh or fish.", exit_code::usage);
    return static_cast<int>(exit_code::usage);
  }
  const std::string text = maker->second();
  const bool good =
      std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  return static_cast<int>(good ? exit_code::ok : exit_code::bad_file);
}

}  // namespace g4_dump
