// SPDX-License-Identifier: MIT
// Baud rates without a POSIX constant.
#pragma once

#include <cstdint>

namespace g4lidar {

/// Like ioctl(). Not system_calls: this header is for a file that cannot include <termios.h>.
using ioctl_call = int (*)(int fd, unsigned long request, void* argument);

/// Sets the rate of the port, in both directions. On failure returns false and sets errno.
[[nodiscard]] bool set_custom_baud(ioctl_call ioctl, int fd, std::uint32_t baud) noexcept;

/// The rate of the port; 0, with errno, if the system does not report it.
[[nodiscard]] std::uint32_t custom_baud(ioctl_call ioctl, int fd) noexcept;

/// A difference of at most 2 %: a connection tolerates it, and the kernel treats the rates as
/// equal.
[[nodiscard]] constexpr bool is_near(std::uint32_t baud, std::uint32_t wanted) noexcept {
  const std::uint64_t off = baud > wanted ? baud - wanted : wanted - baud;
  return off * 50 <= wanted;
}

}  // namespace g4lidar
