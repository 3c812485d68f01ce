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
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

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

  /// Its exit code, 128 and more for a signal that ended it; -1 if it does not end within 30 s.
  [[nodiscard]] int wait() {
    for (int i = 0; i < 3000; ++i) {
      int status = 0;
      const pid_t ended = ::waitpid(pid_, &status, WNOHANG);
      if (ended == pid_) {
        pid_ = -1;
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return -1;
  }

  /// Its output so far.
  [[nodiscard]] std::string output() const {
    std::ifstream file(output_);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  /// Whether its output contains this within 30 s.
  [[nodiscard]] bool prints(const std::string& text) const {
    for (int i = 0; i < 3000; ++i) {
      if (output().find(text) != std::string::npos) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }

 private:
  pid_t pid_ = -1;
  std::string output_;
};

}  // namespace g4lidar::test
