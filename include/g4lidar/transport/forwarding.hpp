// SPDX-License-Identifier: MIT
// Transports and connectors that wrap another one: override the functions that differ.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <utility>

#include "g4lidar/transport/connector.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar {

/// A transport that forwards every call to another one, which it owns. A base for transports that
/// observe or change the bytes: a log, a recording, a fault in a test.
class forwarding_transport : public transport {
 public:
  /// `inner` is not null.
  explicit forwarding_transport(std::unique_ptr<transport> inner) noexcept
      : inner_(std::move(inner)) {}

  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override {
    return inner_->read(out, deadline_ns);
  }
  [[nodiscard]] result<void> write(bytes data, std::int64_t deadline_ns) noexcept override {
    return inner_->write(data, deadline_ns);
  }
  [[nodiscard]] result<void> pause(std::int64_t deadline_ns) noexcept override {
    return inner_->pause(deadline_ns);
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return inner_->now_ns(); }
  void wake() noexcept override { inner_->wake(); }
  [[nodiscard]] int native_handle() const noexcept override { return inner_->native_handle(); }
  [[nodiscard]] std::string_view name() const noexcept override { return inner_->name(); }
  [[nodiscard]] std::uint32_t baud() const noexcept override { return inner_->baud(); }
  [[nodiscard]] result<bool> set_baud(std::uint32_t baud) noexcept override {
    return inner_->set_baud(baud);
  }
  [[nodiscard]] result<bool> set_dtr(bool high) noexcept override { return inner_->set_dtr(high); }
  void keep_dtr() noexcept override { inner_->keep_dtr(); }
  [[nodiscard]] std::size_t kept_bytes() const noexcept override { return inner_->kept_bytes(); }

 protected:
  /// The wrapped transport.
  [[nodiscard]] transport& inner() noexcept { return *inner_; }
  /// The same, const.
  [[nodiscard]] const transport& inner() const noexcept { return *inner_; }

 private:
  std::unique_ptr<transport> inner_;
};

/// A connector that forwards every call to another one, which it owns; override connect() to wrap
/// its transports.
class forwarding_connector : public connector {
 public:
  /// `inner` is not null.
  explicit forwarding_connector(std::unique_ptr<connector> inner) noexcept
      : inner_(std::move(inner)) {}

  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override {
    return inner_->connect();
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return inner_->now_ns(); }
  [[nodiscard]] bool pause(std::int64_t deadline_ns) noexcept override {
    return inner_->pause(deadline_ns);
  }
  void wake() noexcept override { inner_->wake(); }
  void refuse() noexcept override { inner_->refuse(); }
  [[nodiscard]] int watch() noexcept override { return inner_->watch(); }
  [[nodiscard]] bool may_be_back() noexcept override { return inner_->may_be_back(); }
  [[nodiscard]] connector_traits traits() const noexcept override { return inner_->traits(); }
  [[nodiscard]] connector* wrapped() noexcept override { return inner_.get(); }

 protected:
  /// The wrapped connector.
  [[nodiscard]] connector& inner() noexcept { return *inner_; }

 private:
  std::unique_ptr<connector> inner_;
};

}  // namespace g4lidar
