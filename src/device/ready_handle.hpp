// SPDX-License-Identifier: MIT
// One descriptor for event loops that stays the same while the lines behind it come and go.
#pragma once

namespace g4lidar {

/// An epoll set with at most one descriptor in it. *Single thread.*
class ready_handle {
 public:
  ready_handle() noexcept;
  ready_handle(const ready_handle&) = delete;
  ready_handle& operator=(const ready_handle&) = delete;
  ~ready_handle();

  /// Readable from now on when `descriptor` is; a negative one takes the last one out.
  void follow(int descriptor) noexcept;
  /// -1 while nothing has been followed yet.
  [[nodiscard]] int native_handle() const noexcept { return used_ ? set_ : -1; }

 private:
  int set_;
  int followed_ = -1;
  bool used_ = false;
};

}  // namespace g4lidar
