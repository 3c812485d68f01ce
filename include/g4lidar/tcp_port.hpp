// SPDX-License-Identifier: MIT
// A serial line behind a network bridge (ser2net in raw mode, for one) as a transport.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string_view>

#include "g4lidar/error.hpp"
#include "g4lidar/export.hpp"
#include "g4lidar/transport.hpp"

namespace g4lidar {

/// How a connection is made.
struct tcp_options {
  std::chrono::milliseconds connect_timeout{3000};  ///< For all addresses of the host together.
  std::uint32_t baud = 230400;  ///< Of the line at the far end; 0 where there is none.
};

/// Connects to bridges. The transport that comes of it keeps the promises of a serial_port's, with
/// these differences: a connection that its other end closes in order is end_of_input; one that
/// breaks is gone. A network cable that is pulled is silence: the system notices it after about ten
/// seconds.
///
/// *Allocates on open*; afterwards it does not.
class G4LIDAR_API tcp_port {
 public:
  tcp_port() = delete;

  /// Connects to "host:port", "tcp:host:port" or "[address]:port". The timeout does not bound the
  /// asking of a name server, which only the system's resolver can do; numeric addresses and names in
  /// /etc/hosts need none.
  ///
  /// Fails with bad_option (no such form), cannot_connect or system.
  [[nodiscard]] static result<std::unique_ptr<transport>> open(std::string_view address,
                                                               const tcp_options& options = {});
};

}  // namespace g4lidar
