// SPDX-License-Identifier: MIT
// System calls of which one fails as requested. For one test, and thread, at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "transport/system_calls.hpp"

namespace g4lidar::test {

enum class call : std::uint8_t {
  open,
  close,
  stat,
  fstat,
  flock,
  ioctl,
  tcgetattr,
  tcsetattr,
  tcflush,
  eventfd,
  ppoll,
  read,
  write,
  socket,
  connect,
  getsockopt,
  setsockopt,
  send,
};
inline constexpr std::size_t call_count = 18;

/// The fault: none by default.
struct fault {
  call which = call::open;
  int system_errno = 0;            ///< 0: it does not fail.
  int times = 0;                   ///< How often it fails; then it works.
  std::size_t at_most = SIZE_MAX;  ///< Bytes that read, write and send take at a time.
};

void set_fault(const fault& wanted);
/// How often it was called since set_fault().
[[nodiscard]] int made(call which);
[[nodiscard]] std::string_view name_of(call which);

/// The real system calls, with the fault.
[[nodiscard]] const system_calls& faulty_calls();

}  // namespace g4lidar::test
