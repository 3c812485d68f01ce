// SPDX-License-Identifier: MIT
// A descriptor for event loops that does not change when the transport changes.
#pragma once

#include "owned_fd.hpp"

namespace g4lidar {

/// An epoll set with at most one descriptor in it. *Single thread.*
class ready_handle {
 public:
  ready_handle() noexcept;

  /// From now on readable when `descriptor` is; a negative one removes the last one.
  void follow(int descriptor) noexcept;
  /// While it rests, only a hang-up makes it readable.
  void rest(bool wanted) noexcept;
  /// -1 before the first call.
  [[nodiscard]] int native_handle() const noexcept { return used_ ? set_.get() : -1; }

 private:
  owned_fd set_;
  int followed_ = -1;
  bool used_ = false;
  bool rests_ = false;
};

}  // namespace g4lidar
