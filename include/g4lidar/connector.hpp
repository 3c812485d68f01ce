// SPDX-License-Identifier: MIT
// Where a device is to be found, again and again: what a driver that reconnects stands on.
#pragma once

#include <cstdint>
#include <memory>

#include "g4lidar/error.hpp"
#include "g4lidar/export.hpp"
#include "g4lidar/transport.hpp"

namespace g4lidar {

/// Opens the line to a device, the first time and after each loss. *Single thread* but for wake().
/// Simulations and tests bring one of their own.
class G4LIDAR_API connector {
 public:
  virtual ~connector() = default;
  connector(const connector&) = delete;
  connector& operator=(const connector&) = delete;

  /// A line on which the device may be. Never waits long. Where there are several lines it could be
  /// on, each call gives another one; the driver knows its device by the serial number. Fails with
  /// no_port while there is none, or as transport::read() and the opening of ports do.
  [[nodiscard]] virtual result<std::unique_ptr<transport>> connect() noexcept = 0;

  /// The time, the same as that of the transports.
  [[nodiscard]] virtual std::int64_t now_ns() const noexcept = 0;

  /// Waits while there is no line. False if wake() ended it.
  [[nodiscard]] virtual bool pause(std::int64_t deadline_ns) noexcept = 0;

  /// Ends a pause(), or the next one, early, once. *Any thread.*
  virtual void wake() noexcept = 0;

 protected:
  connector() = default;
};

}  // namespace g4lidar
