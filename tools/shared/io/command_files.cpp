// SPDX-License-Identifier: MIT
#include "command_files.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "cli/named_sources.hpp"
#include "g4lidar/transport/source.hpp"
#include "output.hpp"

namespace g4_tool {
namespace {

/// Of the process: it runs one command.
struct command_files {
  std::vector<std::string> inputs{"-"};
  std::vector<std::string> outputs;
  bool may_replace = false;
};

command_files& ours() noexcept {
  static command_files all;
  return all;
}

/// Standard output by its path.
std::string path_of(const std::string& name) { return name == "-" ? "/dev/stdout" : name; }

/// Where a file is, or will be, whatever leads there: its device and inode, or those of its directory and its name there.
using place = std::tuple<dev_t, ino_t, std::string>;

/// Nothing for what is not on disk.
std::optional<place> place_of(const std::string& name) {
  const std::filesystem::path path = path_of(name);
  struct stat found{};
  if (::stat(path.c_str(), &found) == 0) {
    if (!S_ISREG(found.st_mode)) return std::nullopt;
    return place{found.st_dev, found.st_ino, ""};
  }
  const std::filesystem::path directory = path.has_parent_path() ? path.parent_path() : ".";
  if (::stat(directory.c_str(), &found) != 0) return std::nullopt;
  return place{found.st_dev, found.st_ino, path.filename().string()};
}

/// Whether the word names a source that reads the file, or NAME=SOURCE with such a source.
bool reads(const std::string& word, const std::string& path) {
  const std::size_t at = word.find('=');
  return reads_file(word, path) ||
         (at != std::string::npos && is_lidar_name(std::string_view(word).substr(0, at)) &&
          reads_file(std::string_view(word).substr(at + 1), path));
}

}  // namespace

void add_input(const std::string& word) { ours().inputs.push_back(word); }

void take_back_input(const std::string& word) {
  auto& all = ours().inputs;
  if (const auto at = std::ranges::find(all, word); at != all.end()) all.erase(at);
}

void allow_replacing() noexcept { ours().may_replace = true; }
bool may_replace() noexcept { return ours().may_replace; }

claimed_output::claimed_output(std::string name) : name_(std::move(name)) {
  refuse_inputs();
  std::vector<std::string>& others = ours().outputs;
  const auto here = place_of(name_);
  const bool is_written = std::ranges::any_of(others, [&](const std::string& each) {
    return (here && place_of(each) == here) || (each == "-" && name_ == "-");
  });
  if (is_written) {
    throw failure(exit_code::usage,
                  title_of_output(name_) + " is also another output. Give another name for it.");
  }
  const bool exists = here && std::get<std::string>(*here).empty();
  if (exists && name_ != "-" && !may_replace()) {
    throw failure(exit_code::bad_file,
                  fmt::format("cannot write {}: it exists already. {}", title_of_output(name_),
                              advice_on_writing(EEXIST)));
  }
  others.push_back(name_);
}

claimed_output::~claimed_output() {
  auto& all = ours().outputs;
  all.erase(std::ranges::find(all, name_));
}

void claimed_output::refuse_inputs() const {
  const std::string path = path_of(name_);
  const auto is_input = [&path](const std::string& word) { return reads(word, path); };
  if (std::ranges::none_of(ours().inputs, is_input)) return;
  throw failure(exit_code::usage,
                title_of_output(name_) + " is also the input. Give another name for the output.");
}

}  // namespace g4_tool
