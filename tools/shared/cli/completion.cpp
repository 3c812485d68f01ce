// SPDX-License-Identifier: MIT
// Completion: the program lists what can follow the words of a command line, for the scripts for bash,
// zsh and fish in packaging/completions.
#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "common_options.hpp"
#include "g4lidar/discovery.hpp"
#include "g4lidar/sim/device.hpp"
#include "option_rows.hpp"
#include "setting_words.hpp"
#include "verbs.hpp"

namespace g4_tool {
namespace {

std::vector<std::string> pieces_of(const std::string& text, char between) {
  std::vector<std::string> pieces;
  std::istringstream stream(text);
  for (std::string piece; std::getline(stream, piece, between);) pieces.push_back(piece);
  return pieces;
}

/// Prints the words that begin with `typed`, each with its description.
class offer {
 public:
  explicit offer(std::string typed) : typed_(std::move(typed)) {}

  bool add(std::string_view word, std::string_view meaning = "") {
    if (!word.starts_with(typed_)) return false;
    fmt::print("{}\t{}\n", word, meaning);
    return true;
  }

  /// Adds the values of a row after `before`, such as "--format=".
  void add_values(const option_row& row, const std::string& before = {}) {
    switch (row.complete) {
      case completion::choices:
        for (const std::string& word : pieces_of(row.value, '|')) add(before + word);
        break;
      case completion::setting:
        for (const std::string& word : example_changes()) add(word);
        break;
      case completion::fault:
        for (const std::string& name : fault_names()) add(before + name);
        break;
      case completion::source:
        add_sources();
        [[fallthrough]];
      case completion::input:
      case completion::output:
        fmt::print("/\n");
        break;
      case completion::nothing:
        break;
    }
  }

 private:
  void add_sources() {
    for (const source_form& each : source_forms) {
      const std::size_t colon = each.form.find(':');
      if (colon != std::string_view::npos) add(each.form.substr(0, colon + 1), each.meaning);
    }
    const auto ports = list_ports();
    if (!ports) return;
    for (const port_info& port : *ports) {
      add(port.path, port.product);
      if (!port.bus_path.empty()) add("usb:" + port.bus_path, port.path);
    }
  }

  std::string typed_;
};

/// The verb of that name, or null.
const verb* find_verb(const std::vector<verb>& verbs, std::string_view name) {
  const auto found = std::ranges::find(verbs, name, &verb::name);
  return found == verbs.end() ? nullptr : &*found;
}

}  // namespace

std::vector<std::string> fault_names() {
  std::vector<std::string> names;
  for (int kind = 0; kind <= static_cast<int>(sim::last_fault_kind); ++kind) {
    names.emplace_back(name_of(static_cast<sim::fault_kind>(kind)));
  }
  return names;
}

int complete(std::span<const std::string> words) {
  const std::vector<verb> verbs = this_program().verbs();
  const verb* chosen = verbs.size() == 1 ? &verbs.front() : nullptr;
  const auto before = words.first(words.size() - 1);
  for (const std::string& word : before) {
    if (chosen == nullptr) chosen = find_verb(verbs, word);
  }
  const std::string& typed = words.back();
  offer offered(typed);
  if (chosen == nullptr) {
    bool is_verb = false;
    for (const verb& each : verbs) is_verb |= offered.add(each.name, each.summary);
    if (is_verb) return 0;
    chosen = find_verb(verbs, this_program().default_verb);
  }
  const option_rows rows = joined(chosen->options, global_rows(), standard_rows());
  const std::string name = typed.substr(0, typed.find('='));
  for (const option_row& row : rows) {
    if (row.value.empty()) continue;
    if (!before.empty() && row.has_name(before.back())) return offered.add_values(row), 0;
    if (typed != name && row.has_name(name)) return offered.add_values(row, name + "="), 0;
  }
  if (typed.starts_with('-')) {
    for (const option_row& row : rows) {
      for (const std::string& each : pieces_of(row.names, ',')) offered.add(each, row.help);
    }
    return 0;
  }
  for (const option_row& row : chosen->arguments) offered.add_values(row);
  return 0;
}

}  // namespace g4_tool
