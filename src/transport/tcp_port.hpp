// SPDX-License-Identifier: MIT
// A serial port behind a network bridge (for example ser2net in raw mode) as a transport.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string_view>

#include "g4lidar/core/model.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar {

/// The names of sources behind a bridge begin so.
inline constexpr std::string_view tcp_prefix = "tcp:";
/// *Pure.*
[[nodiscard]] constexpr bool is_bridge(std::string_view source) noexcept {
  return source.starts_with(tcp_prefix);
}

/// How a connection is made.
struct tcp_options {
  std::chrono::milliseconds connect_timeout{3000};  ///< For all addresses of the host together.
  std::uint32_t baud =
      g4_model.bauds[0];  ///< Of the serial port at the far end; 0 if there is none.
};

/// Connects to bridges. The resulting transport keeps the promises of serial_port, with these
/// differences: a connection that the remote end closes properly is end_of_input; one that breaks
/// is gone. A disconnected network cable is silence: the system detects it after about ten seconds.
///
/// *Allocates on open*, not afterwards.
class tcp_port {
 public:
  tcp_port() = delete;

  /// Connects to "host:port", "tcp:host:port" or "[address]:port". The timeout does not include the
  /// query of a name server, which only the resolver of the system can limit; numeric addresses and
  /// names in /etc/hosts need no query.
  ///
  /// Fails with bad_option (another form), cannot_connect or system.
  [[nodiscard]] static result<std::unique_ptr<transport>> open(std::string_view address,
                                                               const tcp_options& options = {});
};

}  // namespace g4lidar
