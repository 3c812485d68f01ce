// SPDX-License-Identifier: MIT
// The USB bridge and the buffer of the host: bytes wait for a while and then arrive together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "fault_injector.hpp"
#include "g4lidar/sim/device_options.hpp"
#include "g4lidar/sim/random.hpp"
#include "ring.hpp"

namespace g4lidar::sim {

class bridge {
 public:
  explicit bridge(const device_options& options) noexcept;

  /// Adds a byte from the connection; false if it is lost because the buffer is full.
  bool take(std::uint8_t byte, fault_injector& faults, std::int64_t now_ns) noexcept;
  /// When the waiting bytes reach the host.
  [[nodiscard]] std::int64_t next_ns() const noexcept { return next_ns_; }
  /// The time has come; during a stall the bytes continue to wait.
  void flush(const fault_injector& faults) noexcept;
  /// Unplugged.
  void reset() noexcept;
  /// The host discards what it has not read.
  void discard() noexcept { host_.clear(); }

  /// The host takes the bytes that have reached it.
  std::size_t read(std::span<std::uint8_t> out) noexcept;
  [[nodiscard]] std::size_t available() const noexcept { return host_.size(); }
  [[nodiscard]] std::int64_t batch_min_ns() const noexcept { return min_ns_; }
  [[nodiscard]] std::uint64_t delivered() const noexcept { return delivered_; }
  [[nodiscard]] std::uint64_t overflowed() const noexcept { return overflowed_; }

 private:
  [[nodiscard]] std::int64_t wait_ns(fault_injector& faults) noexcept;

  std::int64_t min_ns_;
  std::int64_t range_ns_;
  random_stream random_;
  ring<std::uint8_t, 4'096> waiting_;
  ring<std::uint8_t, 65'536> host_;
  std::int64_t next_ns_ = forever_ns;
  std::uint64_t delivered_ = 0;
  std::uint64_t overflowed_ = 0;
};

}  // namespace g4lidar::sim
