// SPDX-License-Identifier: MIT
// A serial port as a transport.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "g4lidar/core/model.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar {

/// How a port is opened. The defaults are those of a G4.
struct serial_options {
  std::uint32_t baud = g4_model.bauds[0];  ///< Any rate that the port supports.
  bool exclusive = true;  ///< Refuse a port that another program has open, and lock it.
  bool low_latency =
      true;  ///< Ask the kernel driver to deliver bytes immediately, if it supports this.
  /// The system keeps its rule for DTR after the last close. Otherwise it lowers the line then, also after a program
  /// that was killed.
  bool leave_dtr = false;
};

/// Opens serial ports. The resulting transport
/// - is raw, 8N1, without flow control; the destructor restores the settings of the port;
/// - delivers a burst with at most two system calls, poll and read, and with one if more bytes are
///   known to be waiting or there is no time to wait;
/// - fails with gone within 100 ms after the port disappears, during read() and pause();
/// - has the descriptor of the port as its native_handle(); a wake() does not make it readable.
///
/// *Allocates on open*, not afterwards.
class G4LIDAR_API serial_port {
 public:
  serial_port() = delete;

  /// Opens the port at `path` and discards bytes that were received before. The port is locked with
  /// flock(), which programs of this library and many others respect, and with TIOCEXCL, which the
  /// system enforces for every user except root.
  ///
  /// Fails with bad_option, no_port, permission, busy (the subject names the process that has it
  /// open, if the system shows it), not_serial, bad_baud_rate or system.
  [[nodiscard]] static result<std::unique_ptr<transport>> open(std::string_view path,
                                                               const serial_options& options = {});
};

}  // namespace g4lidar
