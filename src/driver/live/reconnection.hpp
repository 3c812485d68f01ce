// SPDX-License-Identifier: MIT
// The search for a lost lidar: why it is lost, when the next attempt is due, and what was found.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "driver/error_context.hpp"
#include "g4lidar/settings.hpp"
#include "link/connection.hpp"

namespace g4lidar {

/// *Single thread, never allocates.*
class reconnection {
 public:
  /// The connection is lost or closed.
  void lost(const error& why) noexcept { why_ = why; }
  [[nodiscard]] const error& why() const noexcept { return why_; }
  /// The same, for calls while the lidar is looked for.
  [[nodiscard]] error reconnecting() const noexcept {
    const error_context about = error_context(why_.subject()).add(", ").add(name_of(why_.code()));
    return {task::reading, problem::reconnecting, about};
  }

  /// The lidar is lost: the first attempt is immediate.
  void begin() noexcept {
    backoff_ns_ = 0;
    is_under_way_ = true;
  }
  /// Plans the next attempt; the pauses grow up to `longest_ns`.
  void plan(std::int64_t now_ns, std::int64_t longest_ns) noexcept {
    next_attempt_ns_ = now_ns + backoff_ns_;
    backoff_ns_ = std::min(std::max(2 * backoff_ns_, first_pause_ns), longest_ns);
  }
  /// Waits for the next attempt, at most until the deadline. Returns whether it is due. If a port has
  /// changed, it is due at once, and the pauses are short again.
  [[nodiscard]] bool wait(connection& connection, std::int64_t deadline_ns) noexcept {
    if (connection.now_ns() >= next_attempt_ns_) return true;
    connection.pause(std::min(deadline_ns, next_attempt_ns_));
    if (connection.port_connector().may_be_back()) {
      next_attempt_ns_ = connection.now_ns();
      backoff_ns_ = first_pause_ns;
    }
    return connection.now_ns() >= next_attempt_ns_;
  }
  [[nodiscard]] std::int64_t next_attempt_ns() const noexcept { return next_attempt_ns_; }

  /// Another lidar answered. Returns whether it is to be reported: once.
  [[nodiscard]] bool refuse(const device_information& other) noexcept {
    const bool is_new = refused_ != other.serial_digits;
    refused_ = other.serial_digits;
    return is_new;
  }
  /// The lidar is lost, or its previous state is not restored yet.
  [[nodiscard]] bool is_under_way() const noexcept { return is_under_way_; }
  /// Everything is as it was. Returns whether this ends a loss.
  [[nodiscard]] bool end() noexcept {
    if (!is_under_way_) return false;
    refused_.reset();
    is_under_way_ = false;
    backoff_ns_ = 0;
    ++count_;
    return true;
  }
  /// How often this was so.
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }

 private:
  static constexpr std::int64_t first_pause_ns = 20'000'000;

  error why_{task::reading, problem::gone};
  std::int64_t next_attempt_ns_ = 0;
  std::int64_t backoff_ns_ = 0;
  std::uint64_t count_ = 0;
  bool is_under_way_ = false;
  std::optional<decltype(device_information::serial_digits)> refused_{};
};

}  // namespace g4lidar
