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

/// The difference of two rates, in thousandths of `wanted`, which is not 0. *Pure.*
[[nodiscard]] constexpr std::uint64_t baud_difference(std::uint32_t baud,
                                                      std::uint32_t wanted) noexcept {
  const std::uint64_t off = baud > wanted ? baud - wanted : wanted - baud;
  return off * 1000 / wanted;
}

/// A difference of at most 2 %: the kernel treats the rates as equal.
[[nodiscard]] constexpr bool is_near(std::uint32_t baud, std::uint32_t wanted) noexcept {
  return baud_difference(baud, wanted) <= 20;
}

/// Whether bytes arrive at this difference: at 4 %, the last bit of a byte is sampled within its first
/// or last tenth. Some bridges have few rates: a CP2102 makes 500000 of 512000.
[[nodiscard]] constexpr bool is_tolerable(std::uint32_t baud, std::uint32_t wanted) noexcept {
  return baud_difference(baud, wanted) <= 40;
}

}  // namespace g4lidar
