// SPDX-License-Identifier: MIT
// The connection of a simulated device to programs, which open and close it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "g4lidar/core/bytes.hpp"

namespace g4lidar::sim {

class served_port {
 public:
  served_port() = default;
  served_port(const served_port&) = delete;
  served_port& operator=(const served_port&) = delete;
  virtual ~served_port() = default;

  /// The path or address for programs.
  [[nodiscard]] virtual const std::string& name() const noexcept = 0;
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
};

}  // namespace g4lidar::sim
