// SPDX-License-Identifier: MIT
// A descriptor for event loops that does not change when the transport changes.
#pragma once

#include <sys/epoll.h>

#include "owned_fd.hpp"

namespace g4lidar {

/// An epoll set with at most one descriptor in it. *Single thread.*
class ready_handle {
 public:
  /// From now on readable when `descriptor` is; a negative one removes the last one.
  void follow(int descriptor) noexcept {
    if (!set_) return;
    // A closed descriptor has already left the set; then this call fails, which is correct.
    if (followed_ >= 0) epoll_ctl(set_.get(), EPOLL_CTL_DEL, followed_, nullptr);
    followed_ = descriptor;
    rests_ = false;
    if (descriptor < 0) return;
    epoll_event wanted{};
    wanted.events = EPOLLIN;
    if (epoll_ctl(set_.get(), EPOLL_CTL_ADD, descriptor, &wanted) == 0) used_ = true;
  }
  /// While it rests, only a hang-up makes it readable.
  void rest(bool wanted) noexcept {
    if (followed_ < 0 || rests_ == wanted) return;
    rests_ = wanted;
    epoll_event looked_for{};
    if (!wanted) looked_for.events = EPOLLIN;
    epoll_ctl(set_.get(), EPOLL_CTL_MOD, followed_, &looked_for);
  }
  /// -1 before the first call.
  [[nodiscard]] int native_handle() const noexcept { return used_ ? set_.get() : -1; }

 private:
  owned_fd set_{epoll_create1(EPOLL_CLOEXEC)};
  int followed_ = -1;
  bool used_ = false;
  bool rests_ = false;
};

}  // namespace g4lidar
