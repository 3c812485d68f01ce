// SPDX-License-Identifier: MIT
// Converts the arguments that `ros2 run` and launch files pass to every node to options of this program.
#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <ios>
#include <map>
#include <utility>

#include "cli/logger.hpp"
#include "cli/suggestion.hpp"
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
  const auto found =
      std::ranges::find_if(rows, [&option](const option_row& row) { return row.has_name(option); });
  return found == rows.end() ? nullptr : &*found;
}

/// The namespace and the name of the node, on which other arguments depend.
struct node_names {
  std::string name_space;
  std::string node = "g4lidar";
};

node_names names_in(const words& all) {
  node_names made;
  for (std::size_t i = 0; i + 1 < all.size(); ++i) {
    const std::string& value = all[i + 1];
    if (all[i] == "--namespace") made.name_space = value;
    if (all[i] == "--node-name") made.node = value;
    if (value.starts_with("__ns:=")) made.name_space = assignment(value).second;
    if (value.starts_with("__node:=") || value.starts_with("__name:=")) {
      made.node = assignment(value).second;
    }
  }
  return made;
}

/// Logs an argument that does not apply to this node. As in ROS, it is not an error.
void ignored(const std::string& word, std::string_view why) {
  logger::info(fmt::format("--ros-args: {} is ignored: {}\n", in_quotes(word), why));
}

void remap(const std::string& word, const node_names& names, words& out) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 10> known{
      {{"__ns", "--namespace"},
       {"__node", "--node-name"},
       {"__name", "--node-name"},
       {"scan", "--scan-topic"},
       {"points", "--points-topic"},
       {"odom", "--odometry-topic"},
       {"/diagnostics", "--diagnostics-topic"},
       {"/tf", "--tf-topic"},
       {"/tf_static", "--tf-static-topic"},
       {"run", "--run-topic"}}};
  constexpr std::string_view is_private = "~/";
  auto [from, to] = assignment(word);
  if (from.starts_with(is_private)) from.erase(0, is_private.size());
  if (to.starts_with(is_private)) to.replace(0, 1, full_name(names.name_space, names.node));
  const std::string full =
      (from.starts_with('/') ? "" : full_name(names.name_space, "") + "/") + from;
  const auto* const found = std::ranges::find_if(known, [&, &name = from](const auto& each) {
    const bool is_topic = !each.first.starts_with("__");
    return is_topic ? full_name(names.name_space, each.first) == full : each.first == name;
  });
  if (found == known.end()) {
    ignored(word, "there is no such topic");
  } else {
    out.insert(out.end(), {std::string(found->second), to});
  }
}

/// The options for parameters, by their names; a later value replaces an earlier one.
using parameter_words = std::map<std::string, words>;

void set_parameter(const std::string& name, const YAML::Node& value, const option_rows& rows,
                   parameter_words& out) {
  if (name == "use_sim_time") return;  // has no effect here
  std::string option = "--" + name;
  std::ranges::replace(option, '_', '-');
  const option_row* const row = row_named(rows, option);
  if (row == nullptr) {
    std::vector<std::string> known;
    for (const option_row& each : rows) {
      known.push_back(each.long_name().substr(2));
      std::ranges::replace(known.back(), '-', '_');
    }
    throw bad_value("--ros-args: there is no parameter " + in_quotes(name) +
                    did_you_mean(name, known));
  }
  words& made = out[name];
  made.clear();
  if (row->value.empty()) {
    bool is_set = false;
    if (YAML::convert<bool>::decode(value, is_set)) {
      if (is_set) made.push_back(option);
    } else if (!row->optional_value.empty() && value.IsScalar()) {
      made.push_back(option + "=" + value.Scalar());
    } else {
      throw bad_value("--ros-args: " + in_quotes(name) + " is true or false");
    }
  } else if (value.IsSequence() && row->repeatable) {
    for (const YAML::Node& each : value) made.insert(made.end(), {option, each.as<std::string>()});
  } else if (value.IsScalar()) {
    made.insert(made.end(), {option, value.Scalar()});
  } else {
    throw bad_value("--ros-args: " + in_quotes(name) + " is one value");
  }
}

/// What was found in a file of parameters.
struct found_sections {
  int left = 1000;  // by the aliases of YAML a section may contain itself, or others many times
  bool has_ours = false;
  std::string other{};  // another node
};

/// Reads the sections of a file of parameters that apply to all nodes or to this one.
void read_sections(const YAML::Node& sections, const std::string& above, const node_names& names,
                   const option_rows& rows, parameter_words& out, found_sections& found) {
  for (const auto& section : sections) {
    if (--found.left < 0) throw bad_value("--ros-args: a file of parameters has too many sections");
    const auto key = section.first.as<std::string>();
    std::string name = above;
    name.append(key.starts_with('/') ? "" : "/").append(key);
    if (!section.second.IsMap()) throw bad_value(in_quotes(name) + " has no ros__parameters");
    const YAML::Node parameters = section.second["ros__parameters"];
    if (!parameters) {
      read_sections(section.second, name, names, rows, out, found);
    } else if (name == "/**" || name == "/*" || name == full_name(names.name_space, names.node)) {
      if (parameters.IsSequence() || parameters.IsScalar()) {
        throw bad_value(in_quotes(name) + ": ros__parameters needs names and values");
      }
      found.has_ours = true;
      for (const auto& each : parameters) {
        set_parameter(each.first.as<std::string>(), each.second, rows, out);
      }
    } else {
      found.other = name;
    }
  }
}

/// Reads a file of parameters. One that has only those of other nodes would be ignored without a word.
void read_file(const std::string& path, const node_names& names, const option_rows& rows,
               parameter_words& out) {
  found_sections found;
  read_sections(YAML::LoadFile(path), "", names, rows, out, found);
  if (found.has_ours || found.other.empty()) return;
  throw bad_value(
      fmt::format("--ros-args: {} has no parameters for the node {}, but for {}; docs/migrating.md "
                  "has the options for the parameters of other drivers",
                  in_quotes(path), full_name(names.name_space, names.node), found.other));
}

/// Calls `read`. Errors of the YAML of `what` become a bad_value.
template <class Read>
void with_yaml(const std::string& what, Read read) {
  try {
    read();
  } catch (const YAML::BadFile&) {
    throw bad_value("--ros-args: cannot read " + in_quotes(what));
  } catch (const YAML::Exception& reason) {
    throw bad_value("--ros-args: " + in_quotes(what) + ": " + reason.what());
  } catch (const std::ios_base::failure&) {  // a directory
    throw bad_value("--ros-args: cannot read " + in_quotes(what));
  }
}

}  // namespace

words without_ros_arguments(const words& all, const option_rows& rows) {
  words out;
  parameter_words parameters;
  bool is_ros = false;
  const node_names names = names_in(all);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string& word = all[i];
    if (!is_ros || word == "--") {
      if (word != "--ros-args" && !is_ros) out.push_back(word);
      is_ros = word == "--ros-args";
      continue;
    }
    const bool is_file = word == "--params-file";
    const bool is_parameter = word == "-p" || word == "--param";
    const bool is_remap = word == "-r" || word == "--remap";
    const bool is_enclave = word == "-e" || word == "--enclave";
    const bool has_value =
        is_file || is_parameter || is_remap || is_enclave || word == "--log-level";
    if (!has_value && (word.starts_with("--disable-") || word.starts_with("--enable-"))) continue;
    if (!has_value || i + 1 == all.size()) {
      throw bad_value("--ros-args: " + in_quotes(word) + " is not supported; see --config");
    }
    const std::string& value = all[++i];
    if (is_remap) remap(value, names, out);
    if (is_enclave) ignored(fmt::format("{} {}", word, value), "there is no security");
    if (!is_parameter && !is_file) continue;
    with_yaml(value, [&] {
      if (is_file) return read_file(value, names, rows, parameters);
      const auto [name, text] = assignment(value);
      set_parameter(name, YAML::Load(text), rows, parameters);
    });
  }
  for (const auto& [name, made] : parameters) out.insert(out.end(), made.begin(), made.end());
  return out;
}

}  // namespace g4_tool
