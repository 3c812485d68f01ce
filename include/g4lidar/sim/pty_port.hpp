// SPDX-License-Identifier: MIT
// A simulated lidar on a pseudo-terminal or behind a network bridge, in real time: for any program
// that opens serial ports, or connects to tcp:HOST:PORT.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/sim/device.hpp"

namespace g4lidar::sim {

/// A device with its port. A pseudo-terminal has the rate that a program sets: at another one than that of the
/// device, bytes arrive garbled, unless the options state otherwise. While no program has set a rate (it is
/// 38400 then), all bytes arrive. It has no line DTR, so that a motor that DTR drives is enabled. Its time 0 is when it was opened. While it is unplugged there is neither
/// port nor link; plugging it in creates a new port and moves the link to it. A program that does
/// not read loses bytes, as with a real port, and never delays the device. *Single thread.
/// Allocates on open and on each replug.*
class G4LIDAR_API pty_port {
 public:
  /// Opens a pty in raw mode. If `link` is not empty, a symbolic link to the pty exists there until
  /// the destructor. A link that a terminated program left is replaced. Fails with busy if another
  /// device is running at `link` (system_errno() is EADDRINUSE) or something else exists there
  /// (EEXIST), or with system.
  [[nodiscard]] static result<pty_port> open(device simulated, const std::string& link = {});
  /// Behind a network bridge instead: listens at a numeric IPv4 address and a port (0: any), for
  /// one client at a time; further clients are refused. Fails with bad_option or system.
  [[nodiscard]] static result<pty_port> listen(device simulated, const std::string& address,
                                               std::uint16_t port);
  pty_port(pty_port&&) noexcept;
  pty_port& operator=(pty_port&&) noexcept;
  ~pty_port();

  /// The current name of the port: the link if there is one, the name of the pty, or
  /// "tcp:ADDRESS:PORT". Valid until the next call of process().
  [[nodiscard]] const std::string& path() const noexcept;
  /// The time of the device.
  [[nodiscard]] std::int64_t now_ns() const noexcept;
  /// The device; valid as long as this.
  [[nodiscard]] device& simulated() noexcept;
  /// The number of bytes that were lost because no program had read the bytes before them: a
  /// pseudo-terminal holds at least 4 KiB, usually about 16 KiB.
  [[nodiscard]] std::uint64_t bytes_lost() const noexcept;

  /// Moves bytes in both directions without waiting. Returns the latest time for the next call, in
  /// ns of now_ns(). Fails with system if a replug failed.
  [[nodiscard]] result<std::int64_t> process();
  /// For poll(): call process() when one of them is readable. -1: none.
  struct handles {
    int client;
    int visitors;
  };
  /// The current ones; a replug replaces them.
  [[nodiscard]] handles native_handles() const noexcept;

 private:
  class state;
  explicit pty_port(std::unique_ptr<state> made) noexcept;
  static result<pty_port> opened(std::unique_ptr<state> made);
  std::unique_ptr<state> state_;
};

/// Runs all of them until `stop` becomes readable or hangs up. `after_each`, if given, is called
/// whenever something may have happened. Waits without busy looping. Fails like process().
[[nodiscard]] G4LIDAR_API result<void> serve(std::span<pty_port> ports, int stop,
                                             const std::function<void()>& after_each = {});

/// One device with a thread of its own, for tests of programs that need a path.
class G4LIDAR_API background_pty {
 public:
  /// Like pty_port::open(), and starts the thread. Fails with busy or system.
  [[nodiscard]] static result<background_pty> open(device simulated, const std::string& link = {});
  background_pty(background_pty&&) noexcept;
  background_pty& operator=(background_pty&&) noexcept;
  /// Removes the port, like an unplug.
  ~background_pty();

  /// See pty_port; with faults or unplug() it stays valid only if there is a link.
  [[nodiscard]] const std::string& path() const noexcept;
  /// Calls a function with the device, which may unplug it, between two steps of the thread. *Any thread.* The function
  /// may call the functions of this.
  void with(const std::function<void(device& simulated, std::int64_t now_ns)>& look);
  /// See pty_port. *Any thread.*
  [[nodiscard]] std::uint64_t bytes_lost() const;

 private:
  class state;
  explicit background_pty(std::unique_ptr<state> made) noexcept;
  std::unique_ptr<state> state_;
};

}  // namespace g4lidar::sim
