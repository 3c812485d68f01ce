// SPDX-License-Identifier: MIT
// A second program for the test: started, signalled, waited for, and always ended.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "support/patience.hpp"

namespace g4lidar::test {

class child_process {
 public:
  /// Its standard output and error go to the file `output`.
  child_process(std::vector<std::string> words, std::string output) : output_(std::move(output)) {
    posix_spawn_file_actions_t files;
    ::posix_spawn_file_actions_init(&files);
    constexpr int flags = O_WRONLY | O_CREAT | O_TRUNC;
    ::posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_addopen(&files, 1, output_.c_str(), flags, 0600);
    ::posix_spawn_file_actions_adddup2(&files, 1, 2);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    EXPECT_EQ(::posix_spawn(&pid_, arguments[0], &files, nullptr, arguments.data(), environ), 0)
        << words[0];
    ::posix_spawn_file_actions_destroy(&files);
  }
  child_process(const child_process&) = delete;
  child_process& operator=(const child_process&) = delete;
  ~child_process() {
    if (pid_ <= 0) return;
    send(SIGKILL);
    static_cast<void>(::waitpid(pid_, nullptr, 0));
  }

  void send(int signal) const {
    if (pid_ > 0) ::kill(pid_, signal);
  }

  /// Its exit code, 128 and more for a signal that ended it; -1 if it does not end within `patience`.
  [[nodiscard]] int wait() {
    int status = 0;
    if (!comes_true([&] { return ::waitpid(pid_, &status, WNOHANG) == pid_; })) return -1;
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

  /// Its output so far.
  [[nodiscard]] std::string output() const {
    std::ifstream file(output_);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  /// Whether its output contains this within `patience`.
  [[nodiscard]] bool prints(const std::string& text) const {
    return comes_true([&] { return output().find(text) != std::string::npos; });
  }

 private:
  pid_t pid_ = -1;
  std::string output_;
};

}  // namespace g4lidar::test
