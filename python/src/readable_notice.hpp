// SPDX-License-Identifier: MIT
// A descriptor that wakes event loops.
#pragma once

#include <sys/eventfd.h>
#include <unistd.h>

#include <cstdint>

namespace g4lidar::python {

/// Readable from give() until take(). *Any thread.*
class readable_notice {
 public:
  readable_notice() = default;
  readable_notice(const readable_notice&) = delete;
  readable_notice& operator=(const readable_notice&) = delete;
  ~readable_notice() { ::close(descriptor_); }

  void give() noexcept { static_cast<void>(::eventfd_write(descriptor_, 1)); }
  void take() noexcept {
    std::uint64_t count = 0;
    static_cast<void>(::eventfd_read(descriptor_, &count));
  }
  /// -1 if the system has no more descriptors.
  [[nodiscard]] int fileno() const noexcept { return descriptor_; }

 private:
  int descriptor_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
};

}  // namespace g4lidar::python
