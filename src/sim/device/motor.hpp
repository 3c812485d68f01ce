// SPDX-License-Identifier: MIT
// The motor of a simulated lidar: it needs time to reach its speed, and varies around it.
#pragma once

#include <cstdint>

#include "g4lidar/sim/device_options.hpp"

namespace g4lidar::sim {

class motor {
 public:
  explicit motor(const device_options& options) noexcept;

  /// From now on it accelerates towards this speed; 0: not powered, it runs down.
  void drive(std::uint32_t target_mhz, std::int64_t now_ns) noexcept;
  /// Like drive(), but it has the speed immediately.
  void jump(std::uint32_t target_mhz, std::int64_t now_ns) noexcept;
  /// The deviation from its speed.
  void hold(constant_frequency constancy) noexcept;

  [[nodiscard]] std::uint32_t speed_mhz(std::int64_t now_ns) const noexcept;
  [[nodiscard]] bool is_driven() const noexcept { return target_mhz_ != 0; }

 private:
  [[nodiscard]] std::int64_t undisturbed_mhz(std::int64_t now_ns) const noexcept;

  std::int64_t acceleration_mhz_per_s_;
  std::int64_t standstill_ns_;
  std::int64_t period_ns_;
  std::int64_t offset_ns_;  // of its deviation, random
  std::int64_t held_ppm_;
  std::int64_t free_ppm_;
  std::int64_t drift_ppm_;
  std::int64_t since_ns_ = 0;
  std::int64_t from_mhz_ = 0;
  std::uint32_t target_mhz_ = 0;
};

}  // namespace g4lidar::sim
