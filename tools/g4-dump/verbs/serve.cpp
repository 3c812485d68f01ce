// SPDX-License-Identifier: MIT
// The verb serve: runs g4-serve, which needs libraries that g4-dump does not need.
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "cli/exit_code.hpp"
#include "cli/serve_verb.hpp"
#include "verbs/dump_verbs.hpp"

namespace g4_tool {
namespace {

constexpr const char* server = "g4-serve";

/// Executes g4-serve in this process: the one beside this program, else the one in the PATH. It gets the
/// same command line without the verb.
int serve(const serve_options& /*options*/) {
  std::vector<std::string> words = command_line();
  words.erase(std::ranges::find(words, "serve"));
  words.insert(words.begin(), server);
  std::vector<char*> raw;
  raw.reserve(words.size() + 1);
  for (std::string& word : words) raw.push_back(word.data());
  raw.push_back(nullptr);
  std::error_code unimportant;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", unimportant);
  ::execv((self.parent_path() / server).c_str(), raw.data());
  ::execvp(server, raw.data());
  if (errno == ENOENT) {
    throw failure(exit_code::bad_file,
                  "the program g4-serve is not installed. Install the package g4lidar-serve.");
  }
  throw failure(exit_code::bad_file,
                "g4-serve cannot be run: " + std::generic_category().message(errno) +
                    ". Check its permissions.");
}

}  // namespace

verb make_serve_verb() { return make_serve_verb("serve", serve); }

}  // namespace g4_tool
