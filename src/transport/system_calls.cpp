// SPDX-License-Identifier: MIT
#include "system_calls.hpp"

#include <fcntl.h>
#include <sys/eventfd.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace g4lidar {

const system_calls& real_system_calls() noexcept {
  static constexpr system_calls calls{
      .open = [](const char* path, int flags) { return ::open(path, flags); },
      .close = [](int fd) { return ::close(fd); },
      .stat = [](const char* path, struct stat* out) { return ::stat(path, out); },
      .fstat = [](int fd, struct stat* out) { return ::fstat(fd, out); },
      .flock = [](int fd, int operation) { return ::flock(fd, operation); },
      .ioctl = [](int fd, unsigned long request,
                  void* argument) { return ::ioctl(fd, request, argument); },
      .tcgetattr = [](int fd, termios* out) { return ::tcgetattr(fd, out); },
      .tcsetattr = [](int fd, int when,
                      const termios* wanted) { return ::tcsetattr(fd, when, wanted); },
      .tcflush = [](int fd, int which) { return ::tcflush(fd, which); },
      .eventfd = [](unsigned int initial, int flags) { return ::eventfd(initial, flags); },
      .ppoll = [](pollfd* fds, nfds_t count,
                  const timespec* timeout) { return ::ppoll(fds, count, timeout, nullptr); },
      .read = [](int fd, void* out, std::size_t size) { return ::read(fd, out, size); },
      .write = [](int fd, const void* data, std::size_t size) { return ::write(fd, data, size); },
      .socket = [](int domain, int type, int protocol) { return ::socket(domain, type, protocol); },
      .connect = [](int fd, const sockaddr* address,
                    socklen_t size) { return ::connect(fd, address, size); },
      .getsockopt = [](int fd, int level, int name, void* value,
                       socklen_t* size) { return ::getsockopt(fd, level, name, value, size); },
      .setsockopt = [](int fd, int level, int name, const void* value,
                       socklen_t size) { return ::setsockopt(fd, level, name, value, size); },
      .send = [](int fd, const void* data, std::size_t size,
                 int flags) { return ::send(fd, data, size, flags); },
  };
  return calls;
}

}  // namespace g4lidar
