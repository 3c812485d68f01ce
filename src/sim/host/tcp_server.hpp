// SPDX-License-Identifier: MIT
// A TCP socket that forwards raw bytes to one client at a time, as a network bridge does.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "g4lidar/error.hpp"
#include "served_port.hpp"
#include "transport/owned_fd.hpp"

namespace g4lidar::sim {

class tcp_server final : public served_port {
 public:
  /// Listens at a numeric IPv4 address; port 0: any. Fails with bad_option or system.
  [[nodiscard]] static result<std::unique_ptr<served_port>> open(const std::string& address,
                                                                 std::uint16_t port);

  /// "tcp:127.0.0.1:4000"
  [[nodiscard]] const std::string& name() const noexcept override { return name_; }
  [[nodiscard]] int handle() const noexcept override { return client_.get(); }
  [[nodiscard]] int watch() const noexcept override { return listener_.get(); }
  [[nodiscard]] std::size_t read(std::span<std::uint8_t> out) noexcept override;
  std::size_t write(bytes data) noexcept override;
  /// Accepts a client; further ones are refused.
  void look_for_clients() noexcept override;

 private:
  owned_fd listener_;
  owned_fd client_;
  std::string name_;
};

}  // namespace g4lidar::sim
