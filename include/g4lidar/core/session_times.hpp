// SPDX-License-Identifier: MIT
// The times of a session: how long it waits for each reply or event.
#pragma once

#include <cstdint>

#include "g4lidar/detail/api.hpp"

namespace g4lidar {

/// How long a session waits, in nanoseconds. The manual defines protected_ns and keep_alive_ns; the
/// other defaults are chosen so that no healthy device is disturbed. A wait ends as soon as its
/// event occurs, so a long time does not slow down a quick device. The same values are in a table
/// in docs/design/session.md.
struct session_times {
  /// For an answer. Too short: a slow answer is requested again, and a setting takes several tries.
  /// Too long: each lost answer costs this time, up to three times until the link is clear.
  std::int64_t answer_ns = 300'000'000;
  /// For the first answer after opening, a reconnect or a restart, when the device may be booting,
  /// and for each answer of a device that was slow before. Too short: queries accumulate in a
  /// device that boots. Too long: a missing device is detected this much later.
  std::int64_t first_answer_ns = 1'000'000'000;
  /// For the scan header or a packet after a start. Too short: the start is interrupted by a stop
  /// and sent again. Too long: a lost start costs this time.
  std::int64_t start_ns = 2'000'000'000;
  /// A stopped stream has ended when nothing has arrived for this time. Too short: the rest of the
  /// stream disturbs the next answer. Too long: each stop takes this long.
  std::int64_t quiet_ns = 50'000'000;
  /// For a stream to end after a stop. Too short: the stop is sent again without need. Too long: a
  /// lost stop costs this time.
  std::int64_t drain_ns = 400'000'000;
  /// For the first reaction of a device to a restart. Too short: the old restart command is sent,
  /// too. Too long: old firmware, which has only that command, restarts this much later.
  std::int64_t boot_sign_ns = 500'000'000;
  /// For a restarted device to answer. Too short: a slow boot is reported as a failure. Too long: a
  /// device that does not return is reported this much later.
  std::int64_t boot_ns = 5'000'000'000;
  /// Between two keep-alive commands under power-down protection. Too short: unneeded commands. Too
  /// long: one lost command ends the scan.
  std::int64_t keep_alive_ns = 1'000'000'000;
  /// Without a keep-alive for this time, the device stops by itself. Too short: a running scan is
  /// started again. Too long: the end of a scan is attributed to another cause.
  std::int64_t protected_ns = 3'000'000'000;
  /// A started device that has sent no packet by then is reported as spinning up. Too short: every
  /// start reports it. Too long: the user does not know the reason for the wait.
  std::int64_t spin_up_notice_ns = 500'000'000;
  /// For the first packet after the scan header, while the motor spins up. Too short: a cold or
  /// heavy motor is stopped repeatedly and never runs. Too long: a device with insufficient power
  /// for its motor is reported this much later; it gets two such times.
  std::int64_t first_packet_ns = 10'000'000'000;
  /// For the next packet of a running scan. Too short: a pause of the host or of a bridge restarts
  /// the scan. Too long: a device that has stopped is restarted this much later.
  std::int64_t stall_ns = 1'000'000'000;
  /// A request sends no further command after this time. Too short: long settings end incomplete.
  /// Too long: a request on a bad link takes this long.
  std::int64_t request_ns = 10'000'000'000;

  friend constexpr bool operator==(const session_times&, const session_times&) noexcept = default;
};

}  // namespace g4lidar
