// SPDX-License-Identifier: MIT
// A pseudo-terminal that behaves like a serial port: raw, and as new for each program that opens it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "file_handle.hpp"
#include "g4lidar/bytes.hpp"
#include "g4lidar/error.hpp"

namespace g4lidar::sim {

class pty {
 public:
  [[nodiscard]] static result<pty> open();

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] int master() const noexcept { return master_.number(); }
  [[nodiscard]] int watch() const noexcept { return watch_.number(); }

  /// What programs have written; 0: nothing.
  [[nodiscard]] std::size_t read(std::span<std::uint8_t> out) noexcept;
  /// As much as is taken; the rest is lost, and all of it while no program has it open. How much a
  /// program that has it open has lost by this.
  std::size_t write(bytes data) noexcept;
  /// Learns who has opened and closed it. When the last one has gone, it is as new.
  void look_for_visitors() noexcept;

 private:
  [[nodiscard]] bool make_raw() const noexcept;
  void find_out_whether_watching_works() noexcept;

  file_handle master_;
  file_handle slave_;  // held open, so that the master never hangs up
  file_handle watch_;
  std::string name_;
  int visitors_ = 0;
};

}  // namespace g4lidar::sim
