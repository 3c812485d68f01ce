// SPDX-License-Identifier: MIT
#include "ready_handle.hpp"

#include <sys/epoll.h>

namespace g4lidar {

ready_handle::ready_handle() noexcept : set_(epoll_create1(EPOLL_CLOEXEC)) {}

void ready_handle::follow(int descriptor) noexcept {
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

void ready_handle::rest(bool wanted) noexcept {
  if (followed_ < 0 || rests_ == wanted) return;
  rests_ = wanted;
  epoll_event looked_for{};
  if (!wanted) looked_for.events = EPOLLIN;
  epoll_ctl(set_.get(), EPOLL_CTL_MOD, followed_, &looked_for);
}

}  // namespace g4lidar
