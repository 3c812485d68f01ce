// SPDX-License-Identifier: MIT
// The environment of a simulation run: a device, a clock, and transports that report each call.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "g4lidar/sim/device.hpp"
#include "g4lidar/sim/virtual_port.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar::simulation {

/// The calls of a driver to its transports.
struct transport_calls {
  std::uint64_t reads = 0;  ///< That brought something,
  std::uint64_t empty = 0;  ///< and those that did not.
  std::uint64_t writes = 0;
  std::uint64_t pauses = 0;
  std::uint64_t connects = 0;
};

struct environment {
  environment(const sim::device_options& options, std::span<const sim::fault> faults)
      : device(sim::built_in_world(), options, faults) {}

  sim::device device;
  sim::virtual_clock clock;
  transport_calls calls;
  std::function<void()> on_call;    ///< Before each call: all that was read before is digested.
  std::int64_t wake_ns = never_ns;  ///< Then somebody wakes the driver, once.
  std::function<void()> wake;
  std::uint32_t bridge_baud = 0;  ///< The rate that the host's side has; 0: what is asked for.
  bool watches = true;            ///< Whether the system reports when the device is plugged in.
};

/// A transport that reports each call, and during which the driver may be woken.
class observed_transport final : public transport {
 public:
  explicit observed_transport(environment& on, std::unique_ptr<transport> port)
      : environment_(&on), port_(std::move(port)) {}

  result<received> read(std::span<std::uint8_t> out, std::int64_t deadline_ns) noexcept override {
    environment_->on_call();
    auto got = port_->read(out, until(deadline_ns));
    if (got && got->count == 0 && wakes()) got = port_->read(out, deadline_ns);
    ++(got && got->count > 0 ? environment_->calls.reads : environment_->calls.empty);
    return got;
  }
  result<void> write(bytes data, std::int64_t deadline_ns) noexcept override {
    environment_->on_call();
    ++environment_->calls.writes;
    return port_->write(data, deadline_ns);
  }
  result<void> pause(std::int64_t deadline_ns) noexcept override {
    environment_->on_call();
    ++environment_->calls.pauses;
    auto done = port_->pause(until(deadline_ns));
    if (done && wakes()) done = port_->pause(deadline_ns);
    return done;
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return port_->now_ns(); }
  void wake() noexcept override { port_->wake(); }
  [[nodiscard]] result<bool> set_baud(std::uint32_t baud) noexcept override {
    environment_->on_call();
    return port_->set_baud(environment_->bridge_baud != 0 ? environment_->bridge_baud : baud);
  }
  [[nodiscard]] result<bool> set_dtr(bool high) noexcept override {
    environment_->on_call();
    return port_->set_dtr(high);
  }
  [[nodiscard]] std::string_view name() const noexcept override { return port_->name(); }
  [[nodiscard]] std::uint32_t baud() const noexcept override { return port_->baud(); }
  [[nodiscard]] std::size_t kept_bytes() const noexcept override { return port_->kept_bytes(); }

 private:
  [[nodiscard]] std::int64_t until(std::int64_t deadline_ns) const noexcept {
    return std::min(deadline_ns, std::max(environment_->wake_ns, now_ns()));
  }
  [[nodiscard]] bool wakes() noexcept {
    if (now_ns() < environment_->wake_ns) return false;
    environment_->wake_ns = never_ns;
    environment_->wake();
    return true;
  }

  environment* environment_;
  std::unique_ptr<transport> port_;
};

class observed_connector final : public connector {
 public:
  explicit observed_connector(environment& on)
      : environment_(&on), connector_(on.device, on.clock) {}

  result<std::unique_ptr<transport>> connect() noexcept override {
    environment_->on_call();
    ++environment_->calls.connects;
    auto port = connector_.connect();
    if (!port) return port;
    if (environment_->bridge_baud != 0) {
      if (auto set = (*port)->set_baud(environment_->bridge_baud); !set) {
        return tl::unexpected(std::move(set).error());
      }
    }
    return std::make_unique<observed_transport>(*environment_, std::move(*port));
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return connector_.now_ns(); }
  bool pause(std::int64_t deadline_ns) noexcept override {
    environment_->on_call();
    ++environment_->calls.pauses;
    if (!environment_->watches) return connector_.pause(deadline_ns);
    while (!has_returned() && now_ns() < deadline_ns) {
      if (!connector_.pause(std::min(deadline_ns, now_ns() + 1'000'000))) return false;
    }
    return true;
  }
  [[nodiscard]] bool may_be_back() noexcept override {
    if (!environment_->watches || !has_returned()) return false;
    replugs_ = environment_->device.replugs();
    return true;
  }
  void wake() noexcept override { connector_.wake(); }

 private:
  [[nodiscard]] bool has_returned() noexcept {
    return environment_->device.is_plugged(now_ns()) && environment_->device.replugs() != replugs_;
  }

  environment* environment_;
  sim::virtual_connector connector_;
  std::uint64_t replugs_ = 0;
};

}  // namespace g4lidar::simulation
