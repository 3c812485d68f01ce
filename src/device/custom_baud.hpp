// SPDX-License-Identifier: MIT
// Baud rates that POSIX has no name for.
#pragma once

#include <cstdint>

namespace g4lidar {

/// As ioctl() does. Not system_calls: this header is for a file that cannot see <termios.h>.
using ioctl_call = int (*)(int fd, unsigned long request, void* argument);

/// Sets the port's rate to a number, both ways. False, and errno, where the system cannot.
[[nodiscard]] bool set_custom_baud(ioctl_call ioctl, int fd, std::uint32_t baud) noexcept;

/// The rate that the port has; 0, and errno, where the system does not tell.
[[nodiscard]] std::uint32_t custom_baud(ioctl_call ioctl, int fd) noexcept;

/// Off by at most 2 %: what a line still bears, and what the kernel takes for the same.
[[nodiscard]] constexpr bool is_near(std::uint32_t baud, std::uint32_t wanted) noexcept {
  const std::uint64_t off = baud > wanted ? baud - wanted : wanted - baud;
  return off * 50 <= wanted;
}

}  // namespace g4lidar
