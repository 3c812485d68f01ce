// SPDX-License-Identifier: MIT
// What carries bytes to and from a device: a serial port, a network bridge, a file, a simulation; what opens it,
// repeatedly; and the classes that wrap either.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/transport/recognition.hpp"

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

struct model;

/// What is behind a connector.
struct connector_traits {
  /// Whether a device answers on the transports. Nothing is written to files and recordings.
  bool answers = true;
  /// Whether the clock is counted from the bytes that were read, so that no call waits.
  bool counts_time = false;
  /// Wall clock minus now_ns() of the connector, if it is better known than by the system: the bytes
  /// of a file arrived when they were recorded.
  std::optional<std::int64_t> wall_ahead_ns{};
  /// What is known about the model. As long as nothing is, `model` is null and `by` nothing. Its candidates are valid as
  /// long as the connector.
  g4lidar::recognition recognised{};
  /// As which model the driver of a recording read it at first, if `recognised` has another one. Valid forever.
  const model* begun_as = nullptr;
  /// Whether the model was searched at the device, or will be: its port could not be opened yet.
  bool is_searched = false;
};

/// Opens the transport to a device, the first time and after each loss. *Single thread* except
/// wake(). Simulations and tests provide their own.
class G4LIDAR_API connector {
 public:
  virtual ~connector() = default;
  connector(const connector&) = delete;
  connector& operator=(const connector&) = delete;

  /// A transport to which the device may be attached. Returns soon. If there are several
  /// candidates, each call returns another one; the driver identifies its device by the serial
  /// number. Fails with no_port if there is none, or like transport::read() and the opening of
  /// ports.
  [[nodiscard]] virtual result<std::unique_ptr<transport>> connect() noexcept = 0;

  /// The time, by the same clock as that of the transports.
  [[nodiscard]] virtual std::int64_t now_ns() const noexcept = 0;

  /// Waits while there is no transport. Returns false if wake() ended the wait.
  [[nodiscard]] virtual bool pause(std::int64_t deadline_ns) noexcept = 0;

  /// Ends a waiting pause(), or the next one, early, once. *Any thread.*
  virtual void wake() noexcept = 0;

  /// On the last transport another lidar than the wanted one answered. A connector that can detect
  /// a replug does not return that port again before its replug; other connectors do nothing.
  virtual void refuse() noexcept {}

  // A connector that wraps another one must forward these functions, too: derive it from
  // forwarding_connector, below.

  /// Begins to watch for the return of a lost device. Returns a descriptor for poll() that is readable when
  /// may_be_back() may be true; -1 if there is none. Called again, it changes nothing.
  [[nodiscard]] virtual int watch() noexcept { return -1; }
  /// Whether a port has appeared or changed since the last call, so that connect() may succeed; this also
  /// ends a pause() early. Without it the driver tries at growing intervals only.
  [[nodiscard]] virtual bool may_be_back() noexcept { return false; }

  /// What is behind this connector, at this time.
  [[nodiscard]] virtual connector_traits traits() const noexcept { return {}; }
  /// The connector that this one wraps, which is valid as long as this; null if there is none.
  [[nodiscard]] virtual connector* wrapped() noexcept { return nullptr; }

 protected:
  connector() = default;
};

/// A transport that forwards every call to another one, which it owns. A base for transports that
/// observe or change the bytes: a log, a recording, a fault in a test.
class forwarding_transport : public transport {
 public:
  /// `inner` is not null.
  explicit forwarding_transport(std::unique_ptr<transport> inner) noexcept
      : inner_(std::move(inner)) {}

  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override {
    return inner_->read(out, deadline_ns);
  }
  [[nodiscard]] result<void> write(bytes data, std::int64_t deadline_ns) noexcept override {
    return inner_->write(data, deadline_ns);
  }
  [[nodiscard]] result<void> pause(std::int64_t deadline_ns) noexcept override {
    return inner_->pause(deadline_ns);
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return inner_->now_ns(); }
  void wake() noexcept override { inner_->wake(); }
  [[nodiscard]] int native_handle() const noexcept override { return inner_->native_handle(); }
  [[nodiscard]] std::string_view name() const noexcept override { return inner_->name(); }
  [[nodiscard]] std::uint32_t baud() const noexcept override { return inner_->baud(); }
  [[nodiscard]] result<bool> set_baud(std::uint32_t baud) noexcept override {
    return inner_->set_baud(baud);
  }
  [[nodiscard]] result<bool> set_dtr(bool high) noexcept override { return inner_->set_dtr(high); }
  void keep_dtr() noexcept override { inner_->keep_dtr(); }
  [[nodiscard]] std::size_t kept_bytes() const noexcept override { return inner_->kept_bytes(); }

 protected:
  /// The wrapped transport.
  [[nodiscard]] transport& inner() noexcept { return *inner_; }
  /// The same, const.
  [[nodiscard]] const transport& inner() const noexcept { return *inner_; }

 private:
  std::unique_ptr<transport> inner_;
};

/// A connector that forwards every call to another one, which it owns; override connect() to wrap
/// its transports.
class forwarding_connector : public connector {
 public:
  /// `inner` is not null.
  explicit forwarding_connector(std::unique_ptr<connector> inner) noexcept
      : inner_(std::move(inner)) {}

  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override {
    return inner_->connect();
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return inner_->now_ns(); }
  [[nodiscard]] bool pause(std::int64_t deadline_ns) noexcept override {
    return inner_->pause(deadline_ns);
  }
  void wake() noexcept override { inner_->wake(); }
  void refuse() noexcept override { inner_->refuse(); }
  [[nodiscard]] int watch() noexcept override { return inner_->watch(); }
  [[nodiscard]] bool may_be_back() noexcept override { return inner_->may_be_back(); }
  [[nodiscard]] connector_traits traits() const noexcept override { return inner_->traits(); }
  [[nodiscard]] connector* wrapped() noexcept override { return inner_.get(); }

 protected:
  /// The wrapped connector.
  [[nodiscard]] connector& inner() noexcept { return *inner_; }

 private:
  std::unique_ptr<connector> inner_;
};

}  // namespace g4lidar
