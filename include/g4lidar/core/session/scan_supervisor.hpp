// SPDX-License-Identifier: MIT
// Supervises a running scan: when a keep-alive is due, and whether the scan has ended by itself.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>

#include "g4lidar/core/command.hpp"
#include "g4lidar/core/request.hpp"
#include "g4lidar/core/response.hpp"
#include "g4lidar/core/session_times.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/settings.hpp"

namespace g4lidar {

/// What to do for a running scan.
enum class scan_need : std::uint8_t {
  nothing,
  spinning_up,  ///< Report that no packet has arrived yet. Once per scan.
  keep_alive,   ///< Send a start command as keep-alive for the protection.
  starved,      ///< The same, but it is too late.
  found_protected,  ///< Stop and start: it ended at the time of the protection. Send keep-alives from now on.
  restart,  ///< Stop and start: it ended for another reason.
  give_up,  ///< Like restart, but beyond the limit.
};

/// What a session reports then.
[[nodiscard]] constexpr notice notice_of(scan_need need) noexcept {
  switch (need) {
    case scan_need::spinning_up:
      return notice::spinning_up;
    case scan_need::starved:
      return notice::protection_starved;
    case scan_need::found_protected:
      return notice::protection_found_on;
    case scan_need::restart:
      return notice::restarted;
    case scan_need::give_up:
      return notice::stalled;
    case scan_need::nothing:
    case scan_need::keep_alive:
      break;
  }
  return notice::none;
}

/// Supervises a scan. *Single thread.* (protocol: The stream, power-down protection)
class scan_supervisor {
 public:
  constexpr scan_supervisor() noexcept = default;

  /// A start was sent.
  constexpr void start_sent(std::int64_t now_ns) noexcept { last_start_ns_ = now_ns; }
  /// The scan runs, by its header or a first packet.
  constexpr void runs(std::int64_t now_ns) noexcept {
    since_ns_ = last_packet_ns_ = now_ns;
    has_packets_ = is_reported_ = false;
  }
  /// A packet has arrived.
  constexpr void packet(std::int64_t now_ns) noexcept {
    last_packet_ns_ = std::max(last_packet_ns_, now_ns);
    has_packets_ = true;
    is_assumed_ = false;
  }
  /// From its start to its last packet, also for a scan that has ended; 0 if none has arrived.
  [[nodiscard]] constexpr std::int64_t length_ns() const noexcept {
    return detail::saturating_sub(last_packet_ns_, since_ns_);
  }
  /// Forgets the restarts of a scan that is not wanted any more.
  constexpr void forget_restarts() noexcept { restarts_ = 0; }

  /// The state of the protection, if it is known.
  [[nodiscard]] constexpr std::optional<power_down_protection> protection() const noexcept {
    return protection_;
  }
  /// It was set, or nothing is known about it any more.
  constexpr void set_protection(std::optional<power_down_protection> now) noexcept {
    protection_ = now;
  }

  /// This was answered to a command: the protection may be known now.
  constexpr void answered(command code, const response_view& heard) noexcept {
    const auto byte = heard.as_byte();
    if (byte && code == command::protection_toggle) {
      protection_ = reply_byte<power_down_protection>(*byte);
    }
  }
  /// The effect of a command is not known.
  constexpr void unanswered(command code) noexcept {
    if (code == command::protection_toggle) protection_.reset();
  }

  /// When look() is due, if no packet arrives.
  [[nodiscard]] constexpr std::int64_t next_look_ns(const session_times& times) const noexcept {
    std::int64_t next = detail::saturating_add(last_packet_ns_, patience_ns(times));
    if (is_unreported())
      next = std::min(next, detail::saturating_add(since_ns_, times.spin_up_notice_ns));
    return is_protected()
               ? std::min(next, detail::saturating_add(last_start_ns_, times.keep_alive_ns))
               : next;
  }

  /// What to do now.
  [[nodiscard]] constexpr scan_need look(std::int64_t now_ns, const session_times& times) noexcept {
    if (length_ns() >= detail::saturating_twice(times.protected_ns))
      restarts_ = 0;  // it ran long enough to forget earlier restarts
    if (is_protected() && detail::saturating_sub(now_ns, last_start_ns_) > times.protected_ns)
      return scan_need::starved;
    if (detail::saturating_sub(now_ns, last_packet_ns_) >= patience_ns(times))
      return judge_end(times);
    if (is_unreported() && detail::saturating_sub(now_ns, since_ns_) >= times.spin_up_notice_ns) {
      is_reported_ = true;
      return scan_need::spinning_up;
    }
    const bool is_due =
        is_protected() && detail::saturating_sub(now_ns, last_start_ns_) >= times.keep_alive_ns;
    return is_due ? scan_need::keep_alive : scan_need::nothing;
  }

  /// A scan header has arrived during the scan. After a pause it is the header of another scan.
  [[nodiscard]] constexpr scan_need header(std::int64_t now_ns,
                                           const session_times& times) noexcept {
    const bool is_new = has_packets_ && detail::saturating_sub(now_ns, last_packet_ns_) >=
                                            detail::saturating_twice(times.quiet_ns);
    return is_new ? judge_end(times) : scan_need::nothing;
  }

 private:
  friend struct session_test_access;
  static constexpr int max_restarts = 3;         // of a scan that always ends early
  static constexpr int max_silent_restarts = 1;  // of a scan that never sends a packet

  [[nodiscard]] constexpr bool is_protected() const noexcept {
    return protection_ == power_down_protection::on || is_assumed_;
  }
  [[nodiscard]] constexpr bool is_unreported() const noexcept {
    return !has_packets_ && !is_reported_;
  }
  [[nodiscard]] constexpr std::int64_t patience_ns(const session_times& times) const noexcept {
    return has_packets_ ? times.stall_ns : std::max(times.first_packet_ns, times.stall_ns);
  }

  /// Why a scan ended without a stop command.
  [[nodiscard]] constexpr scan_need judge_end(const session_times& times) noexcept {
    if (restarts_ >= (has_packets_ ? max_restarts : max_silent_restarts)) return scan_need::give_up;
    ++restarts_;
    const std::int64_t alone_ns = detail::saturating_sub(last_packet_ns_, last_start_ns_);
    const std::int64_t slack_ns = times.protected_ns / 6;
    const bool is_starved = alone_ns > detail::saturating_sub(times.protected_ns, slack_ns) &&
                            alone_ns < detail::saturating_add(times.protected_ns, slack_ns);
    // A protection in unknown state may have stopped the device before its first packet.
    is_assumed_ = !has_packets_ && !protection_;
    if (is_protected() || !is_starved) return scan_need::restart;
    protection_ = power_down_protection::on;
    return scan_need::found_protected;
  }

  std::int64_t last_start_ns_ = 0;
  std::int64_t since_ns_ = 0;
  std::int64_t last_packet_ns_ = 0;  // or of the header
  std::optional<power_down_protection> protection_;
  std::uint8_t restarts_ = 0;
  bool has_packets_ = false;
  bool is_reported_ = false;  // spinning_up was reported
  bool is_assumed_ = false;   // the protection is assumed on, until the first packet
};

}  // namespace g4lidar
