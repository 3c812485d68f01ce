// SPDX-License-Identifier: MIT
#include "faulty_calls.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>

namespace g4lidar::test {
namespace {

constexpr std::array<std::string_view, call_count> names{
    "open",    "close", "stat", "fstat", "flock",  "ioctl",   "tcgetattr",  "tcsetattr",  "tcflush",
    "eventfd", "ppoll", "read", "write", "socket", "connect", "getsockopt", "setsockopt", "send"};

fault current;
std::array<std::atomic<int>, call_count> counts;

bool fails(call which) {
  ++counts[static_cast<std::size_t>(which)];
  if (current.which != which || current.system_errno == 0 || current.times == 0) return false;
  --current.times;
  errno = current.system_errno;
  return true;
}

template <call Which, auto Member>
struct faulty;

template <call Which, class Result, class... Arguments,
          Result (*system_calls::*Member)(Arguments...)>
struct faulty<Which, Member> {
  static Result invoke(Arguments... arguments) {
    if (fails(Which)) return -1;
    return (real_system_calls().*Member)(arguments...);
  }
};

std::size_t allowed(call which, std::size_t size) {
  return current.which == which ? std::min(size, current.at_most) : size;
}

ssize_t faulty_read(int fd, void* out, std::size_t size) {
  if (fails(call::read)) return -1;
  return real_system_calls().read(fd, out, allowed(call::read, size));
}

ssize_t faulty_write(int fd, const void* data, std::size_t size) {
  if (fails(call::write)) return -1;
  return real_system_calls().write(fd, data, allowed(call::write, size));
}

ssize_t faulty_send(int fd, const void* data, std::size_t size, int flags) {
  if (fails(call::send)) return -1;
  return real_system_calls().send(fd, data, allowed(call::send, size), flags);
}

// After an interruption it continues in the background.
int faulty_connect(int fd, const sockaddr* address, socklen_t size) {
  const int connected = real_system_calls().connect(fd, address, size);
  return fails(call::connect) ? -1 : connected;
}

// close() closes the descriptor, whatever it returns.
int faulty_close(int fd) {
  const int closed = real_system_calls().close(fd);
  return fails(call::close) ? -1 : closed;
}

}  // namespace

void set_fault(const fault& wanted) {
  current = wanted;
  for (auto& count : counts) count = 0;
}

int made(call which) { return counts[static_cast<std::size_t>(which)]; }

std::string_view name_of(call which) { return names[static_cast<std::size_t>(which)]; }

const system_calls& faulty_calls() {
  static const system_calls calls{
      .open = faulty<call::open, &system_calls::open>::invoke,
      .close = faulty_close,
      .stat = faulty<call::stat, &system_calls::stat>::invoke,
      .fstat = faulty<call::fstat, &system_calls::fstat>::invoke,
      .flock = faulty<call::flock, &system_calls::flock>::invoke,
      .ioctl = faulty<call::ioctl, &system_calls::ioctl>::invoke,
      .tcgetattr = faulty<call::tcgetattr, &system_calls::tcgetattr>::invoke,
      .tcsetattr = faulty<call::tcsetattr, &system_calls::tcsetattr>::invoke,
      .tcflush = faulty<call::tcflush, &system_calls::tcflush>::invoke,
      .eventfd = faulty<call::eventfd, &system_calls::eventfd>::invoke,
      .ppoll = faulty<call::ppoll, &system_calls::ppoll>::invoke,
      .read = faulty_read,
      .write = faulty_write,
      .socket = faulty<call::socket, &system_calls::socket>::invoke,
      .connect = faulty_connect,
      .getsockopt = faulty<call::getsockopt, &system_calls::getsockopt>::invoke,
      .setsockopt = faulty<call::setsockopt, &system_calls::setsockopt>::invoke,
      .send = faulty_send,
  };
  return calls;
}

}  // namespace g4lidar::test
