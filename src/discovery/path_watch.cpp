// SPDX-License-Identifier: MIT
#include "path_watch.hpp"

#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace g4lidar {

path_watch::path_watch(std::string_view path)
    : path_((path.find('/') == std::string_view::npos ? "./" : "") + std::string(path)),
      fd_(inotify_init1(IN_CLOEXEC | IN_NONBLOCK)) {
  follow();
}

/// The directory of the path may be missing: udevd removes /dev/serial/by-id with its last link. Then the
/// nearest one that exists is watched. To watch a directory again changes nothing.
void path_watch::follow() noexcept {
  if (!fd_) return;
  constexpr std::uint32_t changes = IN_CREATE | IN_MOVED_TO | IN_ATTRIB;
  static_cast<void>(inotify_add_watch(fd_.get(), "/dev", changes));
  for (std::size_t end = path_.rfind('/'); end != std::string::npos;) {
    path_[end] = '\0';
    const int watched = inotify_add_watch(fd_.get(), end == 0 ? "/" : path_.c_str(), changes);
    path_[end] = '/';
    if (watched >= 0 || end == 0) return;
    end = path_.rfind('/', end - 1);
  }
}

bool path_watch::concerns(std::string_view name) const noexcept {
  // Without a name: a watched directory has changed, or events were dropped.
  return name.empty() || name.starts_with("tty") || path_.find(name) != std::string::npos;
}

bool path_watch::take() noexcept {
  alignas(inotify_event) std::array<char, 4096> read{};
  bool changed = false;
  for (ssize_t size = 0; (size = ::read(fd_.get(), read.data(), read.size())) > 0;) {
    const char* const end = read.data() + size;
    for (const char* at = read.data(); at < end;) {
      inotify_event change{};
      std::memcpy(&change, at, sizeof change);
      at += sizeof change;
      changed = concerns(change.len > 0 ? std::string_view(at) : std::string_view()) || changed;
      at += change.len;
    }
    follow();
  }
  return changed;
}

}  // namespace g4lidar
