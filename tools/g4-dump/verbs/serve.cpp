// SPDX-License-Identifier: MIT
// The verb serve: another program does it, because it needs libraries that g4-dump does not.
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "cli/exit_code.hpp"
#include "cli/serve_verb.hpp"
#include "verbs/verbs.hpp"

namespace g4_tool {
namespace {

constexpr const char* server = "g4-serve";

/// The command line of the other program: the same words, without that of the verb.
std::vector<std::string> words_for_server() {
  std::vector<std::string> made{server};
  bool is_named = false;
  for (const std::string& word : command_line()) {
    if (is_named || word != "serve") {
      made.push_back(word);
    } else {
      is_named = true;
    }
  }
  return made;
}

/// Becomes g4-serve: the one beside this program, or that of the PATH.
int serve(const serve_options& /*options*/) {
  std::vector<std::string> words = words_for_server();
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
