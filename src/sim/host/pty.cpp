// SPDX-License-Identifier: MIT
// The slave is kept open, otherwise reads from the master would fail between two programs.
// Therefore the kernel never detects a last close; this file does what the kernel would do then,
// when inotify reports the close.
#include <fcntl.h>
#include <poll.h>
#include <sys/inotify.h>
#include <sys/ioctl.h>
#include <termios.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "name_claim.hpp"
#include "served_port.hpp"
#include "transport/custom_baud.hpp"

namespace g4lidar::sim {
namespace {

// The rate of a new terminal: B38400. A program that sets it cannot be distinguished from one that sets none.
constexpr std::uint32_t unset_baud = 38'400;

class pty final : public served_port {
 public:
  [[nodiscard]] result<void> open() {
    const auto failed = [](const char* what) {
      return failure(task::opening, problem::system, what, errno);
    };
    master_ = owned_fd(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC));
    if (!master_) return failed("a pseudo-terminal");
    std::array<char, 64> name{};
    if (::grantpt(handle()) != 0 || ::unlockpt(handle()) != 0 ||
        ::ptsname_r(handle(), name.data(), name.size()) != 0 ||
        ::fcntl(handle(), F_SETFL, O_NONBLOCK) != 0) {
      return failed("a pseudo-terminal");
    }
    name_ = name.data();
    claim_ = name_claim(name_).hold();
    watch_ = owned_fd(::inotify_init1(IN_NONBLOCK | IN_CLOEXEC));
    if (watch_ && ::inotify_add_watch(watch(), name.data(), IN_OPEN | IN_CLOSE) < 0) watch_.close();
    slave_ = owned_fd(::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
    if (!slave_ || !make_raw()) return failed(name.data());
    find_out_whether_watching_works();
    return {};
  }

  [[nodiscard]] const std::string& name() const noexcept override { return name_; }
  [[nodiscard]] std::uint32_t baud() const noexcept override {
    const auto call = [](int fd, unsigned long request, void* argument) {
      return ::ioctl(fd, request, argument);
    };
    const std::uint32_t rate = custom_baud(call, handle());  // the kernel returns that of the slave
    return rate == unset_baud ? 0 : rate;
  }
  [[nodiscard]] int handle() const noexcept override { return master_.get(); }
  [[nodiscard]] int watch() const noexcept override { return watch_.get(); }

  [[nodiscard]] std::size_t read(std::span<std::uint8_t> out) noexcept override {
    const ssize_t count = ::read(handle(), out.data(), out.size());
    return count > 0 ? static_cast<std::size_t>(count) : 0;
  }

  std::size_t write(bytes data) noexcept override {
    if (watch_ && clients_ <= 0) return 0;
    return unwritten(data, [&](bytes rest) { return ::write(handle(), rest.data(), rest.size()); });
  }

  void look_for_clients() noexcept override {
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

 private:
  [[nodiscard]] bool make_raw() const noexcept {
    termios settings{};
    if (::tcgetattr(slave_.get(), &settings) != 0) return false;
    ::cfmakeraw(&settings);
    ::cfsetspeed(&settings, B38400);
    return ::tcsetattr(slave_.get(), TCSANOW, &settings) == 0;
  }

  // The first event was our own opening.
  void find_out_whether_watching_works() noexcept {
    if (!watch_) return;
    look_for_clients();
    if (clients_ != 1) watch_.close();
    clients_ = 0;
  }

  owned_fd master_;
  owned_fd slave_;  // kept open, so that the master never hangs up
  owned_fd watch_;
  owned_fd claim_;  // shows discovery that a simulated device is behind it
  std::string name_;
  int clients_ = 0;
};

}  // namespace

result<std::unique_ptr<served_port>> open_pty() {
  auto made = std::make_unique<pty>();
  if (auto opened = made->open(); !opened) return tl::unexpected<error>(opened.error());
  return made;
}

}  // namespace g4lidar::sim
