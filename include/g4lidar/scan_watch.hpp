// SPDX-License-Identifier: MIT
// The eye on a running scan: when its protection wants feeding, and when it has ended by itself.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>

#include "g4lidar/command.hpp"

namespace g4lidar {

/// The times of a session, in nanoseconds. The defaults suit a G4 behind a USB bridge.
struct session_times {
  std::int64_t answer_ns = 300'000'000;   ///< An answer has come by then, or it is lost.
  std::int64_t start_ns = 1'000'000'000;  ///< The same for the answer to a start.
  std::int64_t quiet_ns = 50'000'000;     ///< A line silent for so long has been drained.
  std::int64_t drain_ns = 400'000'000;    ///< A device that has not stopped by then is told again.
  std::int64_t boot_sign_ns = 500'000'000;       ///< A restarting device is heard by then, if ever.
  std::int64_t boot_ns = 5'000'000'000;          ///< It answers by then.
  std::int64_t feed_ns = 1'000'000'000;          ///< Under protection a start is sent as often.
  std::int64_t protected_ns = 3'000'000'000;     ///< Without one for so long the device stops.
  std::int64_t first_packet_ns = 1'500'000'000;  ///< A started scan sends a packet by then.
  std::int64_t stall_ns = 1'000'000'000;     ///< A scan that sends nothing for so long has ended.
  std::int64_t request_ns = 10'000'000'000;  ///< After that a request asks nothing a further time.

  friend constexpr bool operator==(const session_times&, const session_times&) noexcept = default;
};

/// What is to be done for a running scan.
enum class scan_need : std::uint8_t {
  nothing,
  feed,             ///< Send a start: the protection wants it.
  starved,          ///< The same, and it comes too late.
  found_protected,  ///< Stop and start: it ended when an unfed protection ends it. Feed from now on.
  restart,          ///< Stop and start: it ended for another reason.
  give_up,          ///< The same, for the last time too often.
};

/// Watches a scan. *Single thread.* (protocol: The stream, power-down protection)
class scan_watch {
 public:
  constexpr scan_watch() noexcept = default;

  /// A start has been sent.
  constexpr void start_sent(std::int64_t now_ns) noexcept { last_start_ns_ = now_ns; }
  /// The scan runs, by its header or a first packet.
  constexpr void runs(std::int64_t now_ns) noexcept {
    since_ns_ = last_packet_ns_ = now_ns;
    has_packets_ = false;
  }
  /// A packet has come.
  constexpr void packet(std::int64_t now_ns) noexcept {
    last_packet_ns_ = std::max(last_packet_ns_, now_ns);
    has_packets_ = true;
  }
  /// Restarts of a scan that is wanted by nobody any more do not count.
  constexpr void forget_restarts() noexcept { restarts_ = 0; }

  /// Which way the protection has fallen, if that is known.
  [[nodiscard]] constexpr std::optional<power_down_protection> protection() const noexcept {
    return protection_;
  }
  /// It has been set, or nothing is known of it any more.
  constexpr void set_protection(std::optional<power_down_protection> now) noexcept {
    protection_ = now;
  }

  /// When look() is due, if no packet comes.
  [[nodiscard]] constexpr std::int64_t next_look_ns(const session_times& times) const noexcept {
    const std::int64_t silent = last_packet_ns_ + patience_ns(times);
    return is_protected() ? std::min(silent, last_start_ns_ + times.feed_ns) : silent;
  }

  /// What is to be done now.
  [[nodiscard]] constexpr scan_need look(std::int64_t now_ns, const session_times& times) noexcept {
    // What a scan ended by, before it was restarted, is forgotten when it has lived long enough.
    if (last_packet_ns_ - since_ns_ >= 2 * times.protected_ns) restarts_ = 0;
    if (is_protected() && now_ns - last_start_ns_ > times.protected_ns) return scan_need::starved;
    if (now_ns - last_packet_ns_ >= patience_ns(times)) return judge_end(times);
    const bool is_hungry = is_protected() && now_ns - last_start_ns_ >= times.feed_ns;
    return is_hungry ? scan_need::feed : scan_need::nothing;
  }

 private:
  friend struct session_state;  // of the test that explores all of them

  static constexpr int max_restarts = 3;  // of a scan that never lives long

  [[nodiscard]] constexpr bool is_protected() const noexcept {
    return protection_ == power_down_protection::on;
  }
  [[nodiscard]] constexpr std::int64_t patience_ns(const session_times& times) const noexcept {
    return has_packets_ ? times.stall_ns : std::max(times.first_packet_ns, times.stall_ns);
  }

  /// Why a scan ended that nobody stopped.
  [[nodiscard]] constexpr scan_need judge_end(const session_times& times) noexcept {
    if (restarts_ == max_restarts) return scan_need::give_up;
    ++restarts_;
    const std::int64_t lived_ns = last_packet_ns_ - last_start_ns_;
    const std::int64_t slack_ns = times.protected_ns / 6;
    const bool unfed =
        lived_ns > times.protected_ns - slack_ns && lived_ns < times.protected_ns + slack_ns;
    if (is_protected() || !unfed) return scan_need::restart;
    protection_ = power_down_protection::on;
    return scan_need::found_protected;
  }

  std::int64_t last_start_ns_ = 0;
  std::int64_t since_ns_ = 0;
  std::int64_t last_packet_ns_ = 0;  // or of the header
  std::optional<power_down_protection> protection_;
  std::uint8_t restarts_ = 0;
  bool has_packets_ = false;
};

}  // namespace g4lidar
