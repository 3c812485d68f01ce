// SPDX-License-Identifier: MIT
// The slave is kept open, otherwise reads from the master would fail between two programs.
// Therefore the kernel never detects a last close; this file does what the kernel would do then,
// when inotify reports the close.
#include "pty.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/inotify.h>
#include <sys/ioctl.h>
#include <termios.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "claim.hpp"

namespace g4lidar::sim {

result<std::unique_ptr<served_port>> pty::open() {
  const auto failed = [](const char* what) {
    return failure(task::opening, problem::system, what, errno);
  };
  auto made = std::make_unique<pty>();
  made->master_ = owned_fd(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC));
  if (!made->master_) return failed("a pseudo-terminal");
  std::array<char, 64> name{};
  if (::grantpt(made->handle()) != 0 || ::unlockpt(made->handle()) != 0 ||
      ::ptsname_r(made->handle(), name.data(), name.size()) != 0 ||
      ::fcntl(made->handle(), F_SETFL, O_NONBLOCK) != 0) {
    return failed("a pseudo-terminal");
  }
  made->name_ = name.data();
  made->claim_ = claim(made->name_).hold();
  made->watch_ = owned_fd(::inotify_init1(IN_NONBLOCK | IN_CLOEXEC));
  if (made->watch_ && ::inotify_add_watch(made->watch(), name.data(), IN_OPEN | IN_CLOSE) < 0) {
    made->watch_.close();
  }
  made->slave_ = owned_fd(::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  if (!made->slave_ || !made->make_raw()) return failed(name.data());
  made->find_out_whether_watching_works();
  return made;
}

// The first event was our own opening.
void pty::find_out_whether_watching_works() noexcept {
  if (!watch_) return;
  look_for_clients();
  if (clients_ != 1) watch_.close();
  clients_ = 0;
}

bool pty::make_raw() const noexcept {
  termios settings{};
  if (::tcgetattr(slave_.get(), &settings) != 0) return false;
  ::cfmakeraw(&settings);
  ::cfsetspeed(&settings, B230400);
  return ::tcsetattr(slave_.get(), TCSANOW, &settings) == 0;
}

void pty::look_for_clients() noexcept {
  if (!watch_) return;
  const int before = clients_;
  alignas(inotify_event) std::array<char, 4096> events;
  for (;;) {
    const ssize_t size = ::read(watch(), events.data(), events.size());
    if (size <= 0) break;
    for (std::size_t at = 0; at < static_cast<std::size_t>(size);) {
      inotify_event event{};
      std::memcpy(&event, events.data() + at, sizeof event);
      if ((event.mask & IN_OPEN) != 0) ++clients_;
      if ((event.mask & IN_CLOSE) != 0) --clients_;
      at += sizeof event + event.len;
    }
  }
  if (before > 0 && clients_ == 0) {
    ::ioctl(slave_.get(), TIOCNXCL);
    ::tcflush(slave_.get(), TCIFLUSH);
    [[maybe_unused]] const bool raw = make_raw();
  }
}

std::size_t pty::read(std::span<std::uint8_t> out) noexcept {
  const ssize_t count = ::read(handle(), out.data(), out.size());
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

std::size_t pty::write(bytes data) noexcept {
  if (watch_ && clients_ <= 0) return 0;
  while (!data.empty()) {
    const ssize_t count = ::write(handle(), data.data(), data.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    data = data.subspan(static_cast<std::size_t>(count));
  }
  return data.size();
}

}  // namespace g4lidar::sim
