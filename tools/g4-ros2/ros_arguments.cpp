// SPDX-License-Identifier: MIT
// The arguments that `ros2 run` and launch files give to every node, as options of this program.
#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "cli/logger.hpp"
#include "options.hpp"

namespace g4_tool {
namespace {

using words = std::vector<std::string>;

/// "from:=to"
std::pair<std::string, std::string> assignment(const std::string& word) {
  const std::size_t at = word.find(":=");
  if (at == std::string::npos || at == 0) {
    throw bad_value("--ros-args: " + in_quotes(word) + " is not of the form NAME:=VALUE");
  }
  return {word.substr(0, at), word.substr(at + 2)};
}

const option_row* row_named(const option_rows& rows, const std::string& option) {
  const auto found = std::ranges::find_if(rows, [&option](const option_row& row) {
    return ("," + row.names + ",").find("," + option + ",") != std::string::npos;
  });
  return found == rows.end() ? nullptr : &*found;
}

void remap(const std::string& word, words& out) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 7> known{
      {{"__ns", "--namespace"},
       {"__node", "--node-name"},
       {"__name", "--node-name"},
       {"scan", "--scan-topic"},
       {"points", "--points-topic"},
       {"odom", "--odometry-topic"},
       {"/diagnostics", "--diagnostics-topic"}}};
  const auto [from, to] = assignment(word);
  const auto* const found =
      std::ranges::find(known, from, &std::pair<std::string_view, std::string_view>::first);
  if (found == known.end()) {
    throw bad_value("--ros-args: there is no topic " + in_quotes(from) + " to be renamed");
  }
  out.insert(out.end(), {std::string(found->second), to});
}

void set_parameter(const std::string& word, const option_rows& rows, words& out) {
  const auto [name, value] = assignment(word);
  if (name == "use_sim_time") return;  // of this program only /clock depends on it
  std::string option = "--" + name;
  std::ranges::replace(option, '_', '-');
  const option_row* const row = row_named(rows, option);
  if (row == nullptr) throw bad_value("--ros-args: there is no parameter " + in_quotes(name));
  if (!row->value.empty()) {
    out.insert(out.end(), {option, value});
  } else if (value == "true") {
    out.push_back(option);
  } else if (value != "false") {
    throw bad_value("--ros-args: " + in_quotes(name) + " is true or false");
  }
}

}  // namespace

words without_ros_arguments(const words& all, const option_rows& rows) {
  words out;
  bool is_ros = false;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string& word = all[i];
    if (!is_ros || word == "--") {
      if (word != "--ros-args" && !is_ros) out.push_back(word);
      is_ros = word == "--ros-args";
      continue;
    }
    const bool has_value = word == "-r" || word == "--remap" || word == "-p" || word == "--param" ||
                           word == "--log-level";
    if (!has_value && (word.starts_with("--disable-") || word.starts_with("--enable-"))) continue;
    if (!has_value || i + 1 == all.size()) {
      throw bad_value("--ros-args: " + in_quotes(word) + " is not supported; see --config");
    }
    const std::string& value = all[++i];
    if (word == "-r" || word == "--remap") remap(value, out);
    if (word == "-p" || word == "--param") set_parameter(value, rows, out);
  }
  return out;
}

}  // namespace g4_tool
