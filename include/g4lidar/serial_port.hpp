// SPDX-License-Identifier: MIT
// A serial port as a transport.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "g4lidar/error.hpp"
#include "g4lidar/export.hpp"
#include "g4lidar/transport.hpp"

namespace g4lidar {

/// How a port is opened. The defaults are a G4's.
struct serial_options {
  std::uint32_t baud = 230400;  ///< Any rate that the port offers.
  bool exclusive = true;        ///< Refuse a port that another program holds, and hold it.
  bool low_latency = true;  ///< Ask the driver to hand bytes over at once, where it can be asked.
};

/// Opens serial ports. The transport that comes of it
/// - is raw, 8N1, without flow control; on destruction the line is as it was found;
/// - delivers a burst with at most two system calls, poll and read, and with one where more is known
///   to be waiting or no time is left to wait;
/// - fails with gone within 100 ms of the port's vanishing, while it waits and while it pauses;
/// - has the port's own descriptor as its native_handle(); a wake() does not make that readable.
///
/// *Allocates on open*; afterwards it does not.
class G4LIDAR_API serial_port {
 public:
  serial_port() = delete;

  /// Opens the port at `path` and discards what was received before. The port is locked with flock(),
  /// which programs of this library and many others respect, and with TIOCEXCL, which the system
  /// enforces on everyone but root.
  ///
  /// Fails with bad_option, no_port, permission, busy (the subject names who holds it, where the
  /// system tells), not_serial, bad_baud_rate or system.
  [[nodiscard]] static result<std::unique_ptr<transport>> open(std::string_view path,
                                                               const serial_options& options = {});
};

}  // namespace g4lidar
