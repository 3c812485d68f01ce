// SPDX-License-Identifier: MIT
// The search for a lost lidar: when the next attempt is due, and what it has found.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "g4lidar/device_information.hpp"

namespace g4lidar {

/// *Single thread, never allocates.*
class reconnection {
 public:
  /// The lidar is lost: the first attempt is immediate.
  void begin() noexcept { backoff_ns_ = 0; }
  /// Plans the next attempt; the pauses grow up to `longest_ns`.
  void plan(std::int64_t now_ns, std::int64_t longest_ns) noexcept {
    next_attempt_ns_ = now_ns + backoff_ns_;
    backoff_ns_ = std::min(std::max(2 * backoff_ns_, first_pause_ns), longest_ns);
  }
  /// A port has changed: the next attempt is immediate, and the pauses are short again.
  void retry_now(std::int64_t now_ns) noexcept {
    next_attempt_ns_ = now_ns;
    backoff_ns_ = first_pause_ns;
  }
  [[nodiscard]] std::int64_t next_attempt_ns() const noexcept { return next_attempt_ns_; }

  /// Another lidar answered. Returns whether it is to be reported: once.
  [[nodiscard]] bool refuse(const device_information& other) noexcept {
    const bool is_new = refused_ != other.serial_digits;
    refused_ = other.serial_digits;
    return is_new;
  }
  /// The lidar has answered; its previous state is not restored yet.
  void found() noexcept { is_under_way_ = true; }
  [[nodiscard]] bool is_under_way() const noexcept { return is_under_way_; }
  /// Everything is as before the loss.
  void end() noexcept {
    refused_.reset();
    is_under_way_ = false;
    backoff_ns_ = 0;
    ++count_;
  }
  /// How often this was so.
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }

 private:
  static constexpr std::int64_t first_pause_ns = 20'000'000;

  std::int64_t next_attempt_ns_ = 0;
  std::int64_t backoff_ns_ = 0;
  std::uint64_t count_ = 0;
  bool is_under_way_ = false;
  std::optional<decltype(device_information::serial_digits)> refused_{};
};

}  // namespace g4lidar
