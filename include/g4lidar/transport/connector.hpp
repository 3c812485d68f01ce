// SPDX-License-Identifier: MIT
// Opens transports to a device, repeatedly: the base for a driver that reconnects.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/recognition.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar {

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
  // forwarding_connector of transport/forwarding.hpp.

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

}  // namespace g4lidar
