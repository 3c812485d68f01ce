// SPDX-License-Identifier: MIT
// A file descriptor that is closed by its owner's destructor.
#pragma once

#include <unistd.h>

#include <cerrno>
#include <utility>

namespace g4lidar {

class owned_fd {
 public:
  using close_call = int (*)(int fd);

  owned_fd() = default;
  explicit owned_fd(int fd, close_call call = ::close) noexcept : call_(call), fd_(fd) {}
  owned_fd(owned_fd&& other) noexcept : call_(other.call_), fd_(std::exchange(other.fd_, -1)) {}
  owned_fd& operator=(owned_fd&& other) noexcept {
    std::swap(call_, other.call_);
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~owned_fd() { close(); }

  /// -1 if there is none.
  [[nodiscard]] int get() const noexcept { return fd_; }
  explicit operator bool() const noexcept { return fd_ >= 0; }
  void close() noexcept {
    if (fd_ < 0) return;
    const int kept = errno;         // errno of the failure that is being reported
    call_(std::exchange(fd_, -1));  // whatever it returns, the descriptor is closed
    errno = kept;
  }

 private:
  close_call call_ = ::close;
  int fd_ = -1;
};

}  // namespace g4lidar
