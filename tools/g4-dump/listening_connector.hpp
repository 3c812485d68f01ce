// SPDX-License-Identifier: MIT
// Lines that are listened to before anything is sent: whether the device scans already.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include "g4lidar/connector.hpp"

namespace g4_dump {

/// Hands on the lines of another connector. On each it waits for a packet first, for `listen_ns`, in
/// which the slowest G4 sends one. The driver tells of a scan only where it hears a whole packet
/// before its own stop is obeyed.
class listening_connector final : public g4lidar::connector {
 public:
  static constexpr std::int64_t listen_ns = 60'000'000;

  /// `heard` becomes true when a packet has come; it has to outlive this.
  listening_connector(std::unique_ptr<g4lidar::connector> lines, bool& heard) noexcept
      : lines_(std::move(lines)), heard_(heard) {}

  [[nodiscard]] g4lidar::result<std::unique_ptr<g4lidar::transport>> connect() noexcept override;
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return lines_->now_ns(); }
  [[nodiscard]] bool pause(std::int64_t deadline_ns) noexcept override {
    return lines_->pause(deadline_ns);
  }
  void wake() noexcept override { lines_->wake(); }

 private:
  std::unique_ptr<g4lidar::connector> lines_;
  bool& heard_;
};

}  // namespace g4_dump
