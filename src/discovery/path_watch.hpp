// SPDX-License-Identifier: MIT
// Detects that a port that disappeared may be back.
#pragma once

#include <string>
#include <string_view>

#include "transport/owned_fd.hpp"

namespace g4lidar {

/// Watches the directory of a path, and /dev, by inotify: the kernel and udevd create the node and its links
/// there, and change their permissions. So it works without udevd, and in a container that shares /dev.
/// *Single thread.* *Allocates on open.*
class path_watch {
 public:
  explicit path_watch(std::string_view path);

  /// For poll(): readable when take() may be true. -1 if the system refuses a watch.
  [[nodiscard]] int native_handle() const noexcept { return fd_.get(); }
  /// Whether the path, one of its directories, or a tty has appeared or changed since the last call.
  [[nodiscard]] bool take() noexcept;

 private:
  void follow() noexcept;
  [[nodiscard]] bool concerns(std::string_view name) const noexcept;

  std::string path_;  // with a slash
  owned_fd fd_;
};

}  // namespace g4lidar
