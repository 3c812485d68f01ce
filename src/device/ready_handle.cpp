// SPDX-License-Identifier: MIT
#include "ready_handle.hpp"

#include <sys/epoll.h>
#include <unistd.h>

namespace g4lidar {

ready_handle::ready_handle() noexcept : set_(epoll_create1(EPOLL_CLOEXEC)) {}

ready_handle::~ready_handle() {
  if (set_ >= 0) ::close(set_);
}

void ready_handle::follow(int descriptor) noexcept {
  if (set_ < 0) return;
  // A descriptor that has been closed has left the set by itself; then this fails, and may.
  if (followed_ >= 0) epoll_ctl(set_, EPOLL_CTL_DEL, followed_, nullptr);
  followed_ = descriptor;
  if (descriptor < 0) return;
  epoll_event wanted{};
  wanted.events = EPOLLIN;
  if (epoll_ctl(set_, EPOLL_CTL_ADD, descriptor, &wanted) == 0) used_ = true;
}

}  // namespace g4lidar
