// SPDX-License-Identifier: MIT
// The reports of a service to systemd: ready, alive, its status, stopping.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace g4_tool {

/// The service's side of systemd's notify protocol (sd_notify(3)), without libsystemd. Without
/// NOTIFY_SOCKET in the environment, as in a shell, all calls have no effect. *Single thread, never
/// waits* except for ready(): a busy manager must not delay a recording.
class service_watch {
 public:
  /// Reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID.
  service_watch();
  service_watch(const service_watch&) = delete;
  service_watch& operator=(const service_watch&) = delete;
  ~service_watch();

  /// READY=1: the service does its work, for which other units may wait. Sent once.
  void ready();
  /// Call it in every turn of the loop. Sends WATCHDOG=1 when half of the unit's WatchdogSec= has passed
  /// since the last one; if the loop hangs, systemd restarts the service.
  void alive(std::int64_t now_ns);
  /// The same, by std::chrono::steady_clock.
  void alive();
  /// STATUS=: one line for `systemctl status`. An unchanged text is not sent again.
  void status(std::string_view text);
  /// STOPPING=1: the service ends. Sent once.
  void stopping();

  /// Whether there is a manager.
  [[nodiscard]] bool has_manager() const noexcept { return fd_ >= 0; }

 private:
  /// Whether it was sent.
  bool send(std::string_view text, int flags) const noexcept;

  int fd_;
  std::int64_t interval_ns_ = 0;  // of the watchdog; 0: none
  std::int64_t next_ns_ = INT64_MIN;
  bool is_ready_ = false;
  bool is_stopping_ = false;
  std::string status_;
};

}  // namespace g4_tool
