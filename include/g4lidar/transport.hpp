// SPDX-License-Identifier: MIT
// What carries bytes to and from a device: a serial port, a network bridge, a file, a simulation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>

#include "g4lidar/bytes.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/export.hpp"
#include "g4lidar/line_note.hpp"

namespace g4lidar {

struct recorded_device;

/// A time that never comes.
inline constexpr std::int64_t never_ns = std::numeric_limits<std::int64_t>::max();

/// Bytes that a transport has delivered.
struct received {
  std::size_t count = 0;        ///< 0: nothing came until the deadline.
  std::int64_t arrival_ns = 0;  ///< When the last of them could first be read, by now_ns().
};

/// A line to a device. *Single thread* but for wake(). Every call returns by its deadline; all times
/// are nanoseconds of now_ns(), which is std::chrono::steady_clock but for simulations.
class G4LIDAR_API transport {
 public:
  virtual ~transport() = default;
  transport(const transport&) = delete;
  transport& operator=(const transport&) = delete;

  /// Reads what is there into `out`, not empty; where nothing is, waits for it until the deadline.
  /// Fails with gone, end_of_input, cancelled (see wake()), interference or system.
  [[nodiscard]] virtual result<received> read(std::span<std::uint8_t> out,
                                              std::int64_t deadline_ns) noexcept = 0;

  /// Writes all of `data`, or fails: as read() does, or with timeout.
  [[nodiscard]] virtual result<void> write(bytes data, std::int64_t deadline_ns) noexcept = 0;

  /// Waits until the deadline whatever comes, or fails as read() does. It lets a reader take in more
  /// bytes at a time. Unlike read() it is *never* ended early by bytes.
  [[nodiscard]] virtual result<void> pause(std::int64_t deadline_ns) noexcept = 0;

  /// The time.
  [[nodiscard]] virtual std::int64_t now_ns() const noexcept = 0;

  /// Makes a read(), write() or pause() that waits, or the next one, fail with cancelled, once.
  /// *Any thread*, and a signal handler.
  virtual void wake() noexcept = 0;

  /// For poll(): readable when read() would not wait; -1 where there is none.
  [[nodiscard]] virtual int native_handle() const noexcept { return -1; }

  /// What this is, for messages: a path, "tcp:host:port". Good as long as this.
  [[nodiscard]] virtual std::string_view name() const noexcept = 0;

  /// Whether a device is at the other end, which answers; with a file there is none.
  [[nodiscard]] virtual bool answers() const noexcept { return true; }

  /// The rate of the line in bits a second, 10 to the byte; 0 where bytes take no time.
  [[nodiscard]] virtual std::uint32_t baud() const noexcept { return 0; }

  // Of recordings; a line to a device does without.

  /// The driver tells what it makes of the bytes; a line that is being recorded keeps it.
  virtual void note(const line_note& /*what*/) noexcept {}
  /// What had happened, when this was recorded, between the last reading and the next one: call until
  /// it gives nothing. Good until the next call of anything.
  [[nodiscard]] virtual std::optional<line_note> noted() noexcept { return std::nullopt; }
  /// What is known of the lidar that was recorded; nothing where this is no recording. Good as long as
  /// this.
  [[nodiscard]] virtual const recorded_device* recorded() const noexcept { return nullptr; }
  /// How far the wall clock is ahead of now_ns(), where the line knows better than the system.
  [[nodiscard]] virtual std::optional<std::int64_t> wall_ahead_ns() const noexcept {
    return std::nullopt;
  }

 protected:
  transport() = default;
};

}  // namespace g4lidar
