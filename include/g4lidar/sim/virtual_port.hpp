// SPDX-License-Identifier: MIT
// A transport to a simulated lidar in the same program, in virtual time: waiting takes no real time.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/sim/device.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar::sim {

/// The time that devices and the ports to them share. *Single thread.*
class virtual_clock {
 public:
  /// Each call of a port or connector takes `tick_ns`, so that a loop that never waits also ends;
  /// 0: time passes only by waiting.
  explicit virtual_clock(std::int64_t tick_ns = 1'000) noexcept : tick_ns_(tick_ns) {}

  /// The time.
  [[nodiscard]] std::int64_t now_ns() const noexcept { return now_ns_; }
  /// Moves the time forward; it never goes back.
  void advance_to(std::int64_t at_ns) noexcept { now_ns_ = at_ns > now_ns_ ? at_ns : now_ns_; }
  /// A call was made.
  void tick() noexcept {
    now_ns_ = g4lidar::detail::saturating_add(now_ns_, tick_ns_);
    ++calls_;
  }
  /// For all ports and connectors.
  [[nodiscard]] std::uint64_t calls() const noexcept { return calls_; }

 private:
  std::int64_t now_ns_ = 0;
  std::int64_t tick_ns_;
  std::uint64_t calls_ = 0;
};

/// A transport to a device in virtual time. The caller owns device and clock, which must outlive
/// it. It opens the port of the device, which raises DTR, and closes it in its destructor. After an
/// unplug a port is invalid, like a descriptor. *Never allocates.*
class G4LIDAR_API virtual_port final : public transport {
 public:
  /// `name` must outlive the port.
  virtual_port(device& simulated, virtual_clock& clock,
               std::string_view name = "virtual:g4") noexcept;
  virtual_port(const virtual_port&) = delete;
  virtual_port& operator=(const virtual_port&) = delete;
  ~virtual_port() override;

  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override;
  [[nodiscard]] result<void> write(bytes data, std::int64_t deadline_ns) noexcept override;
  [[nodiscard]] result<void> pause(std::int64_t deadline_ns) noexcept override;
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return clock_->now_ns(); }
  void wake() noexcept override { woken_.store(true, std::memory_order_relaxed); }
  [[nodiscard]] std::string_view name() const noexcept override { return name_; }
  [[nodiscard]] std::uint32_t baud() const noexcept override { return device_->host().baud(); }
  [[nodiscard]] result<bool> set_baud(std::uint32_t baud) noexcept override;
  [[nodiscard]] result<bool> set_dtr(bool high) noexcept override;
  void keep_dtr() noexcept override { is_kept_ = is_raised_; }
  /// As a tty.
  [[nodiscard]] std::size_t kept_bytes() const noexcept override { return 4095; }

 private:
  [[nodiscard]] result<void> look(task doing) noexcept;

  device* device_;
  virtual_clock* clock_;
  std::string_view name_;
  std::uint64_t replugs_;
  bool is_raised_ = false;  // DTR, by set_dtr()
  bool is_kept_ = false;    // when the port is closed
  std::atomic<bool> woken_{false};
};

/// Connects to simulated devices: to those that are plugged in, in turn.
class G4LIDAR_API virtual_connector final : public connector {
 public:
  /// The caller owns devices and clock, which must outlive this.
  virtual_connector(std::vector<device*> devices, virtual_clock& clock)
      : devices_(std::move(devices)), clock_(&clock) {}
  /// The same for one device.
  virtual_connector(device& simulated, virtual_clock& clock)
      : virtual_connector(std::vector<device*>{&simulated}, clock) {}

  /// Ports are opened at this rate from now on; 0, as at first: each at the rate that its host set last.
  void set_baud(std::uint32_t baud) noexcept { baud_ = baud; }

  /// Fails with no_port if none is plugged in.
  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override;
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return clock_->now_ns(); }
  [[nodiscard]] bool pause(std::int64_t deadline_ns) noexcept override;
  void wake() noexcept override { woken_.store(true, std::memory_order_relaxed); }

 private:
  std::vector<device*> devices_;
  std::size_t next_ = 0;
  std::uint32_t baud_ = 0;
  virtual_clock* clock_;
  std::atomic<bool> woken_{false};
};

}  // namespace g4lidar::sim
