// SPDX-License-Identifier: MIT
// The current transport of a driver, the connector of the next one, and the end of a wait on it.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "g4lidar/transport/transport.hpp"
#include "transport/ready_handle.hpp"

namespace g4lidar {

/// *Single thread* except wake().
class connection {
 public:
  /// `device` is the name while there is no transport.
  connection(std::unique_ptr<connector> made, std::string_view device)
      : connector_(std::move(made)), device_(device) {}

  /// Opens a transport instead of the previous one, if the connector has one.
  result<void> open();
  void close() noexcept;
  [[nodiscard]] bool is_open() const noexcept { return transport_ != nullptr; }

  /// The open transport.
  [[nodiscard]] transport& port() noexcept { return *transport_; }
  [[nodiscard]] const transport& port() const noexcept { return *transport_; }
  [[nodiscard]] connector& port_connector() noexcept { return *connector_; }
  /// Sends all of a command. A wake-up does not interrupt it: half a command would be worse than a
  /// late one.
  [[nodiscard]] result<void> send(bytes command) noexcept;
  /// From now on the handle is readable when the device may be back.
  void watch() noexcept { ready_.follow(connector_->watch()); }
  /// Waits while nothing is open; returns early after a wake(), and when the device may be back.
  void pause(std::int64_t deadline_ns) noexcept {
    static_cast<void>(connector_->pause(deadline_ns));
  }

  [[nodiscard]] std::int64_t now_ns() const noexcept { return connector_->now_ns(); }
  [[nodiscard]] std::string_view name() const noexcept {
    return is_open() ? transport_->name() : std::string_view(device_);
  }
  [[nodiscard]] int native_handle() const noexcept { return ready_.native_handle(); }

  /// Whether bytes make the handle readable; a loss always does.
  void rest(bool wanted) noexcept { ready_.rest(wanted); }

  /// *Any thread*, and a signal handler.
  void wake() noexcept;
  /// Whether a call should end early.
  [[nodiscard]] bool is_woken() const noexcept { return woken_.load(std::memory_order_relaxed); }
  /// The same, for the one call that ends.
  [[nodiscard]] bool take_wake() noexcept { return is_woken() && woken_.exchange(false); }
  /// The woken call completed its work; the next call should end instead.
  void wake_next_call() noexcept { woken_.store(true); }

 private:
  std::unique_ptr<transport> exchange(std::unique_ptr<transport> made) noexcept;
  void pass_on_wake() noexcept;

  std::unique_ptr<connector> connector_;
  std::string device_;
  std::atomic_flag changes_;         // held while transport_ changes, and by wake(), which reads it
  std::atomic<bool> woken_ = false;  // a call should end
  std::atomic<bool> to_kick_ = false;  // the waiting transport must be woken
  std::unique_ptr<transport> transport_;
  ready_handle ready_;
};

}  // namespace g4lidar
