// SPDX-License-Identifier: MIT
// The connection of a simulated device to programs, which open and close it.
#pragma once

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/error.hpp"

namespace g4lidar::sim {

class served_port {
 public:
  served_port() = default;
  served_port(const served_port&) = delete;
  served_port& operator=(const served_port&) = delete;
  virtual ~served_port() = default;

  /// The path or address for programs.
  [[nodiscard]] virtual const std::string& name() const noexcept = 0;
  /// The rate that a program has set; 0: none has, or there is no rate.
  [[nodiscard]] virtual std::uint32_t baud() const noexcept { return 0; }
  /// For poll(): readable when programs have written. -1: none.
  [[nodiscard]] virtual int handle() const noexcept = 0;
  /// For poll(): readable when look_for_clients() is due. -1: none.
  [[nodiscard]] virtual int watch() const noexcept = 0;
  /// The bytes that programs have written; 0: none.
  [[nodiscard]] virtual std::size_t read(std::span<std::uint8_t> out) noexcept = 0;
  /// Writes as much as possible; the rest is lost, and everything while no program has it open.
  /// Returns the number of bytes that a program that has it open has lost.
  virtual std::size_t write(bytes data) noexcept = 0;
  /// Checks which programs have opened and closed it. After the last close it is reset.
  virtual void look_for_clients() noexcept = 0;

 protected:
  /// Writes until nothing fits any more; returns the number of bytes that were not written.
  template <class Write>
  [[nodiscard]] static std::size_t unwritten(bytes data, Write write_some) noexcept {
    while (!data.empty()) {
      const auto count = write_some(data);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) break;
      data = data.subspan(static_cast<std::size_t>(count));
    }
    return data.size();
  }
};

/// A pseudo-terminal that behaves like a serial port: raw, and reset for each program that opens it.
[[nodiscard]] result<std::unique_ptr<served_port>> open_pty();

/// A TCP socket that forwards raw bytes to one client at a time, as a network bridge does. Listens at
/// a numeric IPv4 address; port 0: any. Fails with bad_option or system.
[[nodiscard]] result<std::unique_ptr<served_port>> listen_at(const std::string& address,
                                                             std::uint16_t port);

}  // namespace g4lidar::sim
