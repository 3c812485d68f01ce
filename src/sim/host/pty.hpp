// SPDX-License-Identifier: MIT
// A pseudo-terminal that behaves like a serial port: raw, and reset for each program that opens it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/error.hpp"
#include "served_port.hpp"
#include "transport/owned_fd.hpp"

namespace g4lidar::sim {

class pty final : public served_port {
 public:
  [[nodiscard]] static result<std::unique_ptr<served_port>> open();

  [[nodiscard]] const std::string& name() const noexcept override { return name_; }
  [[nodiscard]] int handle() const noexcept override { return master_.get(); }
  [[nodiscard]] int watch() const noexcept override { return watch_.get(); }

  [[nodiscard]] std::size_t read(std::span<std::uint8_t> out) noexcept override;
  std::size_t write(bytes data) noexcept override;
  void look_for_clients() noexcept override;

 private:
  [[nodiscard]] bool make_raw() const noexcept;
  void find_out_whether_watching_works() noexcept;

  owned_fd master_;
  owned_fd slave_;  // kept open, so that the master never hangs up
  owned_fd watch_;
  owned_fd claim_;  // shows discovery that a simulated device is behind it
  std::string name_;
  int clients_ = 0;
};

}  // namespace g4lidar::sim
