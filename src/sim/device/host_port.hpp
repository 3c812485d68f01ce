// SPDX-License-Identifier: MIT
// What the host has set at its port: the rate, and the line DTR, which enables the motor of some models.
#pragma once

#include <cstdint>

#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/sim/device_options.hpp"

namespace g4lidar::sim {

class host_port {
 public:
  explicit host_port(const device_options& options) noexcept
      : own_baud_(options.baud),
        baud_(options.baud),
        start_(options.dtr_starts_by),
        shortest_low_ns_(options.dtr_low_ns),
        low_since_ns_(-options.dtr_low_ns) {}

  void set_baud(std::uint32_t baud) noexcept { baud_ = baud == 0 ? own_baud_ : baud; }
  [[nodiscard]] std::uint32_t baud() const noexcept { return baud_; }

  /// The system raises DTR for the first program that opens the port, and lowers it after the last one, unless that
  /// has asked to keep it.
  void open(std::int64_t now_ns) noexcept {
    if (openings_++ > 0 || is_high_) return;
    is_enabled_ = is_enabled_ && start_ == dtr_start::level;
    raise(now_ns, true);
  }
  void close(std::int64_t now_ns, bool keeps_dtr) noexcept {
    if (openings_ == 0) return;
    --openings_;
    if (openings_ == 0 && !keeps_dtr) lower(now_ns);
  }
  void set_dtr(bool high, std::int64_t now_ns) noexcept {
    if (high) {
      raise(now_ns, false);
    } else {
      lower(now_ns);
    }
  }
  /// The connection has no such line: the motor is enabled.
  void ignore_dtr() noexcept { is_ignored_ = true; }
  /// The bridge loses its power, and each program its port.
  void unplug(std::int64_t now_ns) noexcept {
    if (openings_ > 0 || is_high_) lower(now_ns);
    openings_ = 0;
    baud_ = own_baud_;
  }

  /// Whether DTR enables the motor. It does until somebody opens the port, or sets the line.
  [[nodiscard]] bool enables() const noexcept { return is_enabled_ || is_ignored_; }
  [[nodiscard]] bool is_ignored() const noexcept { return is_ignored_; }

 private:
  void raise(std::int64_t now_ns, bool by_opening) noexcept {
    if (is_high_) return;
    is_high_ = true;
    const bool is_pulse = detail::saturating_sub(now_ns, low_since_ns_) >= shortest_low_ns_;
    const bool is_edge = is_pulse && (start_ == dtr_start::edge || !by_opening);
    is_enabled_ = is_enabled_ || start_ == dtr_start::level || is_edge;
  }
  void lower(std::int64_t now_ns) noexcept {
    if (is_high_) low_since_ns_ = now_ns;
    is_high_ = is_enabled_ = false;
  }

  std::uint32_t own_baud_;
  std::uint32_t baud_;
  dtr_start start_;
  std::int64_t shortest_low_ns_;
  std::int64_t low_since_ns_;
  int openings_ = 0;
  bool is_high_ = false;
  bool is_enabled_ = true;
  bool is_ignored_ = false;
};

}  // namespace g4lidar::sim
