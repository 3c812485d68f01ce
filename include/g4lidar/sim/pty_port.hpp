// SPDX-License-Identifier: MIT
// A simulated G4 on a pseudo-terminal, in real time: any program that opens serial ports can use it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "g4lidar/error.hpp"
#include "g4lidar/export.hpp"
#include "g4lidar/sim/device.hpp"

namespace g4lidar::sim {

/// A device that is being served. Its time 0 is when it was opened. While the plug is out there is
/// neither port nor link; putting it in again makes a new port and moves the link to it. A program
/// that does not read loses bytes, as on a real line, and never holds the device up.
/// *Single thread. Allocates on open and on each replug.*
class G4LIDAR_API pty_port {
 public:
  /// Opens a pty in raw mode. `link`, where not empty, becomes a symbolic link to it until the end;
  /// one that leads to another pty is taken over, anything else there is left alone. Fails with
  /// busy where something stands at `link`, or system.
  [[nodiscard]] static result<pty_port> open(device twin, const std::string& link = {});
  pty_port(pty_port&&) noexcept;
  pty_port& operator=(pty_port&&) noexcept;
  ~pty_port();

  /// Where the port is now: the link where there is one, or the pty's own name. Good until the next
  /// call of process().
  [[nodiscard]] const std::string& path() const noexcept;
  /// The time of the device.
  [[nodiscard]] std::int64_t now_ns() const noexcept;
  /// The device; good as long as this.
  [[nodiscard]] device& twin() noexcept;
  /// How many bytes were lost since no program had read those before them: a pseudo-terminal holds
  /// 4 KiB at least, and some 16 KiB as a rule.
  [[nodiscard]] std::uint64_t bytes_lost() const noexcept;

  /// Carries bytes both ways as far as that goes without waiting; when to call again at the latest,
  /// in ns of now_ns(). Fails with system where a replug could not be brought about.
  [[nodiscard]] result<std::int64_t> process();
  /// For poll(): process() is due when one of them is readable. -1: none.
  struct handles {
    int line;
    int visitors;
  };
  /// Those of now; a replug makes others.
  [[nodiscard]] handles native_handles() const noexcept;

 private:
  class state;
  explicit pty_port(std::unique_ptr<state> made) noexcept;
  std::unique_ptr<state> state_;
};

/// Serves them all until `stop` becomes readable or hangs up. `after_each`, where given, is called
/// whenever something may have happened. Waits without spinning. Fails as process() does.
[[nodiscard]] G4LIDAR_API result<void> serve(std::span<pty_port> ports, int stop,
                                             const std::function<void()>& after_each = {});

/// One device served by a thread of its own, for tests of programs that want a path.
class G4LIDAR_API background_pty {
 public:
  /// As pty_port::open(), and starts the thread. Fails with busy or system.
  [[nodiscard]] static result<background_pty> open(device twin, const std::string& link = {});
  background_pty(background_pty&&) noexcept;
  background_pty& operator=(background_pty&&) noexcept;
  /// Takes the port away, as if unplugged.
  ~background_pty();

  /// As pty_port's; with faults or unplug() good only where there is a link.
  [[nodiscard]] const std::string& path() const noexcept;
  /// Looks at the device, or pulls its plug, between two steps of the thread.
  void with(const std::function<void(device& twin, std::int64_t now_ns)>& look);
  /// As pty_port's.
  [[nodiscard]] std::uint64_t bytes_lost() const;

 private:
  class state;
  explicit background_pty(std::unique_ptr<state> made) noexcept;
  std::unique_ptr<state> state_;
};

}  // namespace g4lidar::sim
