// SPDX-License-Identifier: MIT
// A file descriptor that is closed by its owner's destructor.
#pragma once

#include <cerrno>
#include <utility>

#include "system_calls.hpp"

namespace g4lidar {

class owned_fd {
 public:
  owned_fd(const system_calls& calls, int fd) noexcept : calls_(&calls), fd_(fd) {}
  owned_fd(owned_fd&& other) noexcept : calls_(other.calls_), fd_(std::exchange(other.fd_, -1)) {}
  owned_fd& operator=(owned_fd&&) = delete;
  ~owned_fd() {
    if (fd_ < 0) return;
    const int kept = errno;  // errno of the failure that is being reported
    calls_->close(fd_);      // whatever it returns, the descriptor is closed
    errno = kept;
  }

  /// -1 if there is none.
  [[nodiscard]] int get() const noexcept { return fd_; }

 private:
  const system_calls* calls_;
  int fd_;
};

}  // namespace g4lidar
