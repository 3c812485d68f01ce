// SPDX-License-Identifier: MIT
// The only file that includes the terminal header of the kernel, which defines the names of
// <termios.h> with other values.
#include "custom_baud.hpp"

#include <asm/ioctls.h>
#include <asm/termbits.h>

#include <cerrno>
#include <cstdint>

namespace g4lidar {

#if defined(TCGETS2) && defined(BOTHER)

namespace {

template <class Call>
bool succeeds(Call call) noexcept {
  int got = call();
  while (got == -1 && errno == EINTR) got = call();
  return got == 0;
}

}  // namespace

bool set_custom_baud(ioctl_call ioctl, int fd, std::uint32_t baud) noexcept {
  termios2 settings{};
  if (!succeeds([&] { return ioctl(fd, TCGETS2, &settings); })) return false;
  constexpr tcflag_t both_rates = CBAUD | (CBAUD << IBSHIFT);
  settings.c_cflag =
      (settings.c_cflag & ~both_rates) | BOTHER;  // no separate input rate: the same as the output
  settings.c_ispeed = baud;
  settings.c_ospeed = baud;
  return succeeds([&] { return ioctl(fd, TCSETS2, &settings); });
}

std::uint32_t custom_baud(ioctl_call ioctl, int fd) noexcept {
  termios2 settings{};
  if (!succeeds([&] { return ioctl(fd, TCGETS2, &settings); })) return 0;
  return settings.c_ospeed;
}

#else

bool set_custom_baud(ioctl_call, int, std::uint32_t) noexcept {
  errno = ENOTSUP;
  return false;
}

std::uint32_t custom_baud(ioctl_call, int) noexcept {
  errno = ENOTSUP;
  return 0;
}

#endif

}  // namespace g4lidar
