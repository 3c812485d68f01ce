// SPDX-License-Identifier: MIT
// What carries bytes to and from a device: a serial port, a network bridge, a file, a simulation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"

namespace g4lidar {

/// A time that never comes.
inline constexpr std::int64_t never_ns = std::numeric_limits<std::int64_t>::max();

/// Bytes that a transport delivered.
struct received {
  std::size_t count = 0;        ///< 0: nothing arrived before the deadline.
  std::int64_t arrival_ns = 0;  ///< When the last of them could first be read, by now_ns().
};

/// A connection to a device: bytes, and nothing else. *Single thread* except wake(). Every call
/// returns by its deadline. All times are nanoseconds of now_ns(), which is
/// std::chrono::steady_clock except in simulations.
class G4LIDAR_API transport {
 public:
  virtual ~transport() = default;
  transport(const transport&) = delete;
  transport& operator=(const transport&) = delete;

  /// Reads the available bytes into `out`, which is not empty; if there are none, waits for some
  /// until the deadline. Fails with gone, end_of_input, cancelled (see wake()), interference or
  /// system.
  [[nodiscard]] virtual result<received> read(std::span<std::uint8_t> out,
                                              std::int64_t deadline_ns) noexcept = 0;

  /// Writes all of `data`, or fails: like read(), or with timeout.
  [[nodiscard]] virtual result<void> write(bytes data, std::int64_t deadline_ns) noexcept = 0;

  /// Waits until the deadline, or fails like read(). It lets bytes accumulate for the next read().
  /// Unlike read(), arriving bytes *never* end it early.
  [[nodiscard]] virtual result<void> pause(std::int64_t deadline_ns) noexcept = 0;

  /// The current time.
  [[nodiscard]] virtual std::int64_t now_ns() const noexcept = 0;

  /// Makes a waiting read(), write() or pause(), or the next one, fail with cancelled, once.
  /// *Any thread*, and a signal handler.
  virtual void wake() noexcept = 0;

  /// For poll(): readable when read() would not wait; -1 if there is none.
  [[nodiscard]] virtual int native_handle() const noexcept { return -1; }

  /// The name, for messages: a path, "tcp:host:port". Valid as long as this.
  [[nodiscard]] virtual std::string_view name() const noexcept = 0;

  /// Bits per second, 10 bits per byte; 0 if bytes take no time. Of a serial port the rate that the
  /// system really set.
  [[nodiscard]] virtual std::uint32_t baud() const noexcept { return 0; }

  /// Changes the bits per second, and discards the bytes that were received before. Returns whether the
  /// connection has a rate that can be changed: a network bridge, a file and a pipe have none, and nothing
  /// happens. Fails with bad_baud_rate, or like read().
  [[nodiscard]] virtual result<bool> set_baud(std::uint32_t /*baud*/) noexcept { return false; }

  /// Sets the line DTR, which drives the motor of some lidars. Returns whether the connection has this
  /// line: a pseudo-terminal and a network bridge have none, and nothing happens. Fails like read().
  [[nodiscard]] virtual result<bool> set_dtr(bool /*high*/) noexcept { return false; }
  /// A line that set_dtr() has raised stays high when the port is closed: a motor continues to turn. Otherwise
  /// the system lowers it after the last program, and opening a port raises it again.
  virtual void keep_dtr() noexcept {}

  /// How many bytes the system keeps at least while nobody reads; 0 where nobody knows. A driver that
  /// delivers whole scans sleeps while at most half of them can come.
  [[nodiscard]] virtual std::size_t kept_bytes() const noexcept { return 0; }

 protected:
  transport() = default;
};

}  // namespace g4lidar
