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
      .close = ::close,
      .stat = ::stat,
      .fstat = ::fstat,
      .flock = ::flock,
      .ioctl = [](int fd, unsigned long request,
                  void* argument) { return ::ioctl(fd, request, argument); },
      .tcgetattr = ::tcgetattr,
      .tcsetattr = ::tcsetattr,
      .tcflush = ::tcflush,
      .eventfd = ::eventfd,
      .ppoll = [](pollfd* fds, nfds_t count,
                  const timespec* timeout) { return ::ppoll(fds, count, timeout, nullptr); },
      .read = ::read,
      .write = ::write,
      .socket = ::socket,
      .connect = ::connect,
      .getsockopt = ::getsockopt,
      .setsockopt = ::setsockopt,
      .send = ::send,
  };
  return calls;
}

}  // namespace g4lidar
