// SPDX-License-Identifier: MIT
#include "named_sources.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "common_options.hpp"
#include "g4lidar/transport/source.hpp"
#include "logger.hpp"
#include "option_rows.hpp"

namespace g4_tool {
namespace {

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// The name and the value of "front=/dev/ttyUSB0"; without a name the whole word is the value.
std::pair<std::string, std::string> split_name(const std::string& word) {
  const std::size_t at = word.find('=');
  if (at == std::string::npos || !is_lidar_name(word.substr(0, at))) return {"", word};
  return {word.substr(0, at), word.substr(at + 1)};
}

/// "'front', 'rear'"
std::string list_of(const std::vector<named_source>& lidars) {
  std::string made;
  for (const named_source& each : lidars) {
    made += (made.empty() ? "" : ", ") +
            (each.name.empty() ? "one without a name" : in_quotes(each.name));
  }
  return made;
}

}  // namespace

bool is_lidar_name(std::string_view word) noexcept {
  return !word.empty() && is_letter(word.front()) &&
         std::ranges::all_of(word, [](char c) { return is_letter(c) || is_digit(c); });
}

option_row named_source_arguments(std::vector<std::string>& into, const char* only) {
  option_row row{"SOURCE", "", only, [&into](const std::string& word) { into.push_back(word); }};
  row.complete = completion::source;
  row.repeatable = true;
  return row;
}

option_row named_mount_row(std::vector<named_mounting>& into) {
  option_row row = row_of(*find_parameter("mount"), [&into](const std::string& word) {
    const auto [name, place] = split_name(word);
    into.emplace_back(name, mounting_of(place));
  });
  row.help = "Where the lidar is on the robot; NAME=X,Y,DEG: that lidar (0,0,0)";
  row.repeatable = true;
  return row;
}

option_row merge_row(bool& into) {
  return flag_row("--merge", "Join the lidars by their mountings into one scan", into);
}

std::vector<named_source> named_sources(const std::vector<std::string>& words,
                                        const std::vector<named_mounting>& mounts, bool merges) {
  std::vector<named_source> made;
  std::set<std::string> names;
  for (const std::string& word : words) {
    auto [name, source] = split_name(word);
    if (!names.insert(name).second) {
      throw bad_value(words.size() > 1 && name.empty()
                          ? "several lidars need names: front=" + words.front()
                          : in_quotes(name) + " names two lidars");
    }
    made.push_back({std::move(name), std::move(source), std::nullopt});
  }
  if (made.empty()) made.push_back({"", "", std::nullopt});
  if (made.size() > 1 && names.contains("")) {
    throw bad_value("several lidars need names: front=/dev/ttyUSB0");
  }
  if (merges && std::ranges::any_of(made, names_file, &named_source::source)) {
    throw bad_value("--merge joins lidars; a file has a clock of its own");
  }
  for (const auto& [name, place] : mounts) {
    const auto lidar = std::ranges::find(made, name, &named_source::name);
    if (lidar == made.end()) {
      throw bad_value(fmt::format("--mount: there is no lidar {}; there is {}", in_quotes(name),
                                  list_of(made)));
    }
    lidar->mount = place;
  }
  return made;
}

std::vector<named_source> shown_sources(const std::vector<std::string>& words,
                                        const std::vector<named_mounting>& mounts, bool merges) {
  std::vector<named_source> made = named_sources(words, mounts, merges);
  if (merges) return made;
  if (made.size() > 1) throw bad_value("several lidars are shown as one scan: add --merge");
  made.front().name.clear();
  return made;
}

}  // namespace g4_tool
