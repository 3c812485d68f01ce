// SPDX-License-Identifier: MIT
// Ends the wait of another thread.
#pragma once

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <ctime>

#include "cli/exit_code.hpp"

namespace g4_tool {

/// *Any thread.*
class wake_descriptor {
 public:
  /// Throws a failure.
  wake_descriptor() : fd_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (fd_ >= 0) return;
    if (errno != EMFILE) throw failure(exit_code::internal, "the system gives no eventfd.");
    throw failure(exit_code::bad_file, "Too many files are open. Raise the limit: ulimit -n 1024.");
  }
  wake_descriptor(const wake_descriptor&) = delete;
  wake_descriptor& operator=(const wake_descriptor&) = delete;
  ~wake_descriptor() { ::close(fd_); }

  /// Ends wait(), or the next one.
  void wake() const noexcept { static_cast<void>(::eventfd_write(fd_, 1)); }
  /// Until it is woken, `other` can be read, or the time has come.
  void wait(int other, std::chrono::steady_clock::time_point until) const noexcept {
    using namespace std::chrono_literals;
    const std::chrono::nanoseconds left =
        std::min(until - std::chrono::steady_clock::now(), std::chrono::steady_clock::duration(1h));
    const std::chrono::nanoseconds time = std::max<std::chrono::nanoseconds>(left, 0ns);
    const timespec longest{static_cast<std::time_t>(time / 1s),
                           static_cast<long>((time % 1s).count())};
    std::array<pollfd, 2> waiting{{{fd_, POLLIN, 0}, {other, POLLIN, 0}}};
    static_cast<void>(::ppoll(waiting.data(), waiting.size(), &longest, nullptr));
    eventfd_t count = 0;
    static_cast<void>(::eventfd_read(fd_, &count));
  }

 private:
  int fd_;
};

}  // namespace g4_tool
