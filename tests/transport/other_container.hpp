// SPDX-License-Identifier: MIT
// A process with another pty that has the same path.
#pragma once

#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>
#include <vector>

namespace g4lidar::test {

/// A process, as in another container, that has the pty with the number of `path` open in a devpts of its own.
class other_container {
 public:
  explicit other_container(const std::string& path) {
    const int number = std::stoi(path.substr(path.rfind('/') + 1));
    int ready[2];
    if (::pipe(ready) != 0) return;
    outer_ = ::fork();
    if (outer_ == 0) run(number, ready[1]);
    ::close(ready[1]);
    char byte = 0;
    is_open_ = ::read(ready[0], &byte, 1) == 1;
    ::close(ready[0]);
  }
  other_container(const other_container&) = delete;
  other_container& operator=(const other_container&) = delete;
  ~other_container() {
    ::kill(-outer_, SIGKILL);
    ::waitpid(outer_, nullptr, 0);
  }
  [[nodiscard]] bool is_open() const { return is_open_; }

 private:
  /// The outer process keeps the masters, so that only the inner one looks like a program with an open port.
  [[noreturn]] static void run(int number, int ready) {
    ::setpgid(0, 0);
    ready = ::dup2(ready, STDIN_FILENO);
    ::closefrom(STDERR_FILENO + 1);  // the descriptors of the test
    if (::unshare(CLONE_NEWNS | (::geteuid() == 0 ? 0 : CLONE_NEWUSER)) != 0) ::_exit(1);
    if (::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) ::_exit(1);
    if (::mount("devpts", "/dev/pts", "devpts", 0, "newinstance,ptmxmode=0666") != 0) ::_exit(1);
    std::vector<int> masters;
    for (int each = 0; each <= number; ++each)
      masters.push_back(::open("/dev/pts/ptmx", O_RDWR | O_NOCTTY));
    if (::unlockpt(masters.back()) != 0) ::_exit(1);
    const std::string port = "/dev/pts/" + std::to_string(number);
    if (::open(port.c_str(), O_RDWR | O_NOCTTY) < 0) ::_exit(1);
    if (::fork() == 0) {
      for (const int each : masters) ::close(each);
      if (::write(ready, "r", 1) != 1) ::_exit(1);
    }
    ::close(ready);
    while (true) ::pause();
  }

  pid_t outer_ = 0;
  bool is_open_ = false;
};

}  // namespace g4lidar::test
