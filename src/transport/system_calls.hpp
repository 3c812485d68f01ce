// SPDX-License-Identifier: MIT
// The system calls of the ports, in one table, so that a test can make each of them fail.
#pragma once

#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <ctime>

#include "g4lidar/error.hpp"

namespace g4lidar {

/// Each member is the call of that name: -1 and errno on failure.
struct system_calls {
  int (*open)(const char* path, int flags);
  int (*close)(int fd);
  int (*stat)(const char* path, struct stat* out);
  int (*fstat)(int fd, struct stat* out);
  int (*flock)(int fd, int operation);
  int (*ioctl)(int fd, unsigned long request, void* argument);
  int (*tcgetattr)(int fd, termios* out);
  int (*tcsetattr)(int fd, int when, const termios* wanted);
  int (*tcflush)(int fd, int which);
  int (*eventfd)(unsigned int initial, int flags);
  int (*ppoll)(pollfd* fds, nfds_t count, const timespec* timeout);
  ssize_t (*read)(int fd, void* out, std::size_t size);
  ssize_t (*write)(int fd, const void* data, std::size_t size);
  int (*socket)(int domain, int type, int protocol);
  int (*connect)(int fd, const sockaddr* address, socklen_t size);
  int (*getsockopt)(int fd, int level, int name, void* value, socklen_t* size);
  int (*setsockopt)(int fd, int level, int name, const void* value, socklen_t size);
  ssize_t (*send)(int fd, const void* data, std::size_t size, int flags);
};

/// The real system calls.
[[nodiscard]] const system_calls& real_system_calls() noexcept;

/// EPERM, and what root may not open, are not by the mode of the file.
[[nodiscard]] inline error_detail permission_detail(int why) noexcept {
  return why == EPERM || ::geteuid() == 0 ? error_detail::not_passed : error_detail::usual;
}

/// Repeats the call while signals interrupt it. Not for close(), which has closed the descriptor
/// anyway.
template <class Call>
[[nodiscard]] auto uninterrupted(Call call) noexcept {
  auto got = call();
  while (got == -1 && errno == EINTR) got = call();
  return got;
}

}  // namespace g4lidar
