// SPDX-License-Identifier: MIT
#include "g4lidar/transport/serial_port.hpp"

#include <fcntl.h>
#include <grp.h>
#include <linux/serial.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/sysmacros.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "custom_baud.hpp"
#include "fd_port.hpp"
#include "port_holder.hpp"

namespace g4lidar {
namespace {

struct named_speed {
  std::uint32_t baud;
  speed_t speed;
};

constexpr std::array named_speeds{
    named_speed{1200, B1200},       named_speed{2400, B2400},       named_speed{4800, B4800},
    named_speed{9600, B9600},       named_speed{19200, B19200},     named_speed{38400, B38400},
    named_speed{57600, B57600},     named_speed{115200, B115200},   named_speed{230400, B230400},
    named_speed{460800, B460800},   named_speed{500000, B500000},   named_speed{576000, B576000},
    named_speed{921600, B921600},   named_speed{1000000, B1000000}, named_speed{1152000, B1152000},
    named_speed{1500000, B1500000}, named_speed{2000000, B2000000}, named_speed{2500000, B2500000},
    named_speed{3000000, B3000000}, named_speed{3500000, B3500000}, named_speed{4000000, B4000000},
};

std::optional<speed_t> speed_of(std::uint32_t baud) noexcept {
  const auto* named = std::ranges::find(named_speeds, baud, &named_speed::baud);
  return named == named_speeds.end() ? std::nullopt : std::optional(named->speed);
}

bool has_name(speed_t speed) noexcept {
  return speed <= B38400 ||
         std::ranges::find(named_speeds, speed, &named_speed::speed) != named_speeds.end();
}

/// The flag would remain after a program was killed if another process keeps the slave of a pty
/// open, as simulators do. On a pty only programs that respect the lock need to be kept out.
bool is_pty(const struct stat& file) noexcept {
  return major(file.st_rdev) >= 136 && major(file.st_rdev) <= 143;
}

std::string group_of(gid_t group) {
  std::array<char, 1024> memory{};
  struct group entry{};
  struct group* found = nullptr;
  const int failed = ::getgrgid_r(group, &entry, memory.data(), memory.size(), &found);
  return failed == 0 && found != nullptr ? found->gr_name : std::to_string(group);
}

tl::unexpected<error> busy(const std::string& path, int system_errno = 0) {
  const std::string holder = port_holder(path);
  return failure(task::opening, problem::busy, holder.empty() ? path : path + ", held by " + holder,
                 system_errno);
}

tl::unexpected<error> not_opened(const std::string& path, int system_errno,
                                 const struct stat& file) {
  switch (system_errno) {
    case ENOENT:
    case ENOTDIR:
    case ENXIO:  // a name without a driver or without hardware
    case ENODEV:
    case EIO:
      return failure(task::opening, problem::no_port, path, system_errno);
    case EACCES:
    case EPERM:
      return failure(task::opening, problem::permission,
                     path + " of group " + group_of(file.st_gid), system_errno,
                     permission_detail(system_errno));
    case EBUSY:
      return busy(path, system_errno);
    case EISDIR:
    case ENOTTY:
      return failure(task::opening, problem::not_serial, path, system_errno);
    default:
      return failure(task::opening, problem::system, path, system_errno);
  }
}

result<owned_fd> open_path(const std::string& path, const system_calls& calls) {
  struct stat file{};
  // Checked before it is opened: opening a pipe or a disk can have effects on others.
  if (uninterrupted([&] { return calls.stat(path.c_str(), &file); }) != 0) {
    const int why = errno;
    if (why == EACCES) return failure(task::opening, problem::permission, path, why);
    return not_opened(path, why, file);
  }
  if (is_pty_master(file)) return failure(task::opening, problem::not_serial, path);
  if (!S_ISCHR(file.st_mode)) {
    const bool fits =
        S_ISREG(file.st_mode) && path.size() <= 30;  // the subject holds 95 characters
    const std::string hint = fits ? ", a file, which opens as file:" + path : "";
    return failure(task::opening, problem::not_serial, path + hint);
  }
  constexpr int flags = O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC;
  owned_fd fd(uninterrupted([&] { return calls.open(path.c_str(), flags); }), calls.close);
  if (fd.get() < 0) return not_opened(path, errno, file);
  return fd;
}

// ---- serial_transport -------------------------------------------------------------------------------

/// An open serial port, and the settings that are restored when it is closed.
class serial_transport final : public fd_port {
 public:
  serial_transport(const system_calls& calls, owned_fd fd, std::unique_ptr<waker> waits,
                   std::string path, std::uint32_t baud) noexcept
      : fd_port(calls, std::move(fd), std::move(waits), std::move(path), baud, problem::gone) {}
  ~serial_transport() override {
    if (!is_gone()) restore();
  }

  // In this order, each once. The destructor reverts incomplete steps.
  /// Reads the current settings; not_serial if there are none.
  [[nodiscard]] result<void> look() noexcept;
  [[nodiscard]] result<void> hold();
  [[nodiscard]] result<void> configure(bool drops);  ///< Whether the last close lowers DTR.
  void hasten() noexcept;
  [[nodiscard]] result<void> discard_input() noexcept;

  [[nodiscard]] result<bool> set_baud(std::uint32_t baud) noexcept override;
  [[nodiscard]] result<bool> set_dtr(bool high) noexcept override;
  void keep_dtr() noexcept override {
    if (is_raised_) found_.c_cflag &= ~static_cast<tcflag_t>(HUPCL);
  }

 private:
  [[nodiscard]] ssize_t write_some(bytes data) noexcept override {
    return calls().write(fd(), data.data(), data.size());
  }
  [[nodiscard]] int control(unsigned long request, void* argument) const noexcept {
    return uninterrupted([&] { return calls().ioctl(fd(), request, argument); });
  }
  [[nodiscard]] tl::unexpected<error> refused(int system_errno) const noexcept;
  [[nodiscard]] tl::unexpected<error> refused_baud(std::uint32_t baud,
                                                   int system_errno) const noexcept;
  [[nodiscard]] result<void> apply(std::uint32_t baud, int when) noexcept;
  [[nodiscard]] bool set(int when, const termios& wanted) const noexcept {
    return uninterrupted([&] { return calls().tcsetattr(fd(), when, &wanted); }) == 0;
  }
  [[nodiscard]] bool drained() const noexcept;
  [[nodiscard]] int send_or_discard() noexcept;
  void restore() noexcept;

  termios found_{};
  termios wanted_{};
  std::uint32_t found_custom_baud_ = 0;  // if it had a non-standard rate
  int found_flags_ = 0;
  bool is_changed_ = false;
  bool is_exclusive_ = false;
  bool is_hastened_ = false;
  bool is_raised_ = false;  // DTR, by set_dtr()
};

tl::unexpected<error> serial_transport::refused(int system_errno) const noexcept {
  switch (system_errno) {
    case EIO:
    case ENXIO:
    case ENODEV:
      return failure(task::opening, problem::no_port, name(), system_errno);
    case ENOTTY:
      return failure(task::opening, problem::not_serial, name(), system_errno);
    default:
      return failure(task::opening, problem::system, name(), system_errno);
  }
}

result<void> serial_transport::look() noexcept {
  if (uninterrupted([&] { return calls().tcgetattr(fd(), &found_); }) != 0) {
    return refused(errno == EINVAL ? ENOTTY : errno);  // some devices report it this way
  }
  if (!has_name(cfgetospeed(&found_))) found_custom_baud_ = custom_baud(calls().ioctl, fd());
  return {};
}

// flock() is the guarantee: the system releases it however its holder ends. TIOCEXCL excludes other programs, too.
result<void> serial_transport::hold() {
  if (uninterrupted([&] { return calls().flock(fd(), LOCK_EX | LOCK_NB); }) != 0) {
    if (errno == EWOULDBLOCK) return busy(std::string(name()));
    return failure(task::opening, problem::system, name(), errno);
  }
  int exclusive = 0;  // open() by root succeeds despite it
  if (control(TIOCGEXCL, &exclusive) == 0 && exclusive != 0) return busy(std::string(name()));
  struct stat file{};
  const bool known = uninterrupted([&] { return calls().fstat(fd(), &file); }) == 0;
  if (known && !is_pty(file)) is_exclusive_ = control(TIOCEXCL, nullptr) == 0;
  return {};
}

tl::unexpected<error> serial_transport::refused_baud(std::uint32_t baud,
                                                     int system_errno) const noexcept {
  try {
    return failure(task::configuring, problem::bad_baud_rate,
                   std::string(name()) + " at " + std::to_string(baud) + " baud", system_errno);
  } catch (const std::bad_alloc&) {
    return failure(task::configuring, problem::bad_baud_rate, name(), system_errno);
  }
}

result<void> serial_transport::configure(bool drops) {
  wanted_ = found_;
  cfmakeraw(&wanted_);
  wanted_.c_cflag |= CLOCAL | CREAD | (drops ? HUPCL : 0U);  // also if the program is killed
  wanted_.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB);
  wanted_.c_iflag &= ~static_cast<tcflag_t>(IXOFF | INPCK);
  wanted_.c_cc[VMIN] =
      1;  // with 0, a read without bytes would return 0, like a read from an unplugged port
  wanted_.c_cc[VTIME] = 0;
  return apply(baud(), TCSANOW);
}

/// Sets wanted_ with this rate; baud() becomes the rate that the driver has really set, by the settings.
result<void> serial_transport::apply(std::uint32_t baud, int when) noexcept {
  const auto speed = speed_of(baud);
  cfsetspeed(&wanted_, speed.value_or(B38400));
  is_changed_ = true;
  if (!set(when, wanted_)) return refused(errno);
  if (!speed && !set_custom_baud(calls().ioctl, fd(), baud)) {
    return errno == EIO ? refused(EIO) : refused_baud(baud, errno);
  }
  // tcsetattr() succeeds if any part of it does, so the settings are read back.
  termios got{};
  if (uninterrupted([&] { return calls().tcgetattr(fd(), &got); }) != 0) return refused(errno);
  const auto* const found = std::ranges::find(named_speeds, cfgetospeed(&got), &named_speed::speed);
  const bool is_named = found != named_speeds.end();
  if (is_named && !is_tolerable(found->baud, baud)) return refused_baud(baud, 0);
  const std::uint32_t real = custom_baud(calls().ioctl, fd());
  const bool is_usable = is_tolerable(real, baud);
  if (!is_named && !is_usable) return refused_baud(baud, 0);
  restart_at(is_usable ? real : baud);
  return {};
}

result<bool> serial_transport::set_baud(std::uint32_t baud) noexcept {
  if (baud == 0) return refused_baud(baud, 0);
  auto done = apply(baud, send_or_discard());
  if (done) done = discard_input();
  if (done) return true;
  if (done.error() == problem::bad_baud_rate) return tl::unexpected(done.error());
  return failed(task::configuring, done.error().system_errno());
}

result<bool> serial_transport::set_dtr(bool high) noexcept {
  int line = TIOCM_DTR;
  const bool is_set = control(high ? TIOCMBIS : TIOCMBIC, &line) == 0;
  if (!is_set && errno != ENOTTY && errno != EINVAL) return failed(task::configuring, errno);
  if (!is_set) return false;
  is_raised_ = high;
  if (!high) found_.c_cflag |= HUPCL;  // an earlier program may have kept the line
  return true;
}

void serial_transport::hasten() noexcept {
  serial_struct serial{};
  if (control(TIOCGSERIAL, &serial) != 0) return;
  constexpr int low_latency = static_cast<int>(ASYNC_LOW_LATENCY);
  if ((serial.flags & low_latency) != 0) return;
  found_flags_ = serial.flags;
  serial.flags |= low_latency;
  is_hastened_ = control(TIOCSSERIAL, &serial) == 0;
}

result<void> serial_transport::discard_input() noexcept {
  if (uninterrupted([&] { return calls().tcflush(fd(), TCIFLUSH); }) != 0) return refused(errno);
  return {};
}

/// Waits until the output has been sent, at most 50 ms: more than any command of the library needs.
bool serial_transport::drained() const noexcept {
  for (int tries = 0; tries < 50; ++tries) {
    int waiting = 0;
    if (control(TIOCOUTQ, &waiting) != 0 || waiting == 0) return true;
    const timespec a_while{0, 1'000'000};
    calls().ppoll(nullptr, 0, &a_while);
  }
  return false;
}

/// A last command must not be sent at another rate; and pending output would delay close() for half a
/// minute. Returns when tcsetattr() has to change the settings.
int serial_transport::send_or_discard() noexcept {
  if (drained()) return TCSADRAIN;
  static_cast<void>(uninterrupted([&] { return calls().tcflush(fd(), TCOFLUSH); }));
  return TCSANOW;
}

void serial_transport::restore() noexcept {
  if (is_changed_) {
    static_cast<void>(set(send_or_discard(), found_));
    if (found_custom_baud_ != 0) {
      static_cast<void>(set_custom_baud(calls().ioctl, fd(), found_custom_baud_));
    }
  }
  if (is_hastened_) {
    serial_struct serial{};
    if (control(TIOCGSERIAL, &serial) == 0) {
      serial.flags = found_flags_;
      static_cast<void>(control(TIOCSSERIAL, &serial));
    }
  }
  if (is_exclusive_) static_cast<void>(control(TIOCNXCL, nullptr));
}

// ---- opening -----------------------------------------------------------------------------------

}  // namespace

result<std::unique_ptr<transport>> open_serial_transport(std::string_view path,
                                                         const serial_options& options,
                                                         const system_calls& calls) {
  if (path.empty()) return failure(task::opening, problem::bad_option, "an empty path");
  if (options.baud == 0) return failure(task::opening, problem::bad_option, "baud 0");
  std::string name(path);
  auto fd = open_path(name, calls);
  if (!fd) return tl::unexpected(fd.error());
  auto waits = std::make_unique<waker>(calls);
  if (!waits->is_open()) return failure(task::opening, problem::system, "eventfd", errno);
  auto port = std::make_unique<serial_transport>(calls, std::move(*fd), std::move(waits),
                                                 std::move(name), options.baud);
  if (const auto done = port->look(); !done) return tl::unexpected(done.error());
  if (options.exclusive) {
    if (const auto done = port->hold(); !done) return tl::unexpected(done.error());
  }
  if (auto set = port->configure(!options.leave_dtr); !set) return tl::unexpected(set.error());
  if (options.low_latency) port->hasten();
  if (const auto done = port->discard_input(); !done) return tl::unexpected(done.error());
  return port;
}

result<std::unique_ptr<transport>> serial_port::open(std::string_view path,
                                                     const serial_options& options) {
  return open_serial_transport(path, options, real_system_calls());
}

}  // namespace g4lidar
