// SPDX-License-Identifier: MIT
// What a service reports to systemd: that it is ready, that it runs, what it does, that it ends.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace g4_tool {

/// The service's side of systemd's notify protocol (sd_notify(3)), without libsystemd. Where the
/// environment has no NOTIFY_SOCKET, as in a shell, every call does nothing. *Single thread, never
/// waits* but for ready(): a manager that is busy must not hold up a recording.
class service_watch {
 public:
  /// Reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID.
  service_watch();
  service_watch(const service_watch&) = delete;
  service_watch& operator=(const service_watch&) = delete;
  ~service_watch();

  /// READY=1: the lidar scans, or whatever it is that other units wait for. Sent once.
  void ready();
  /// To be called in every turn of the loop: WATCHDOG=1, as soon as half of the unit's WatchdogSec= has
  /// gone by since the last one. Where the loop hangs, systemd ends the service and starts it anew.
  void alive(std::int64_t now_ns);
  /// The same, by std::chrono::steady_clock.
  void alive();
  /// STATUS=: what `systemctl status` shows, one line. The same text again is not sent again.
  void status(std::string_view text);
  /// STOPPING=1: it was asked to end, or has come to its end. Sent once.
  void stopping();

  /// Whether anybody listens.
  [[nodiscard]] bool is_heard() const noexcept { return fd_ >= 0; }

 private:
  /// Whether it has arrived.
  bool send(std::string_view text, int flags) const noexcept;

  int fd_;
  std::int64_t interval_ns_ = 0;  // of the watchdog; 0: none
  std::int64_t next_ns_ = INT64_MIN;
  bool is_ready_ = false;
  bool is_stopping_ = false;
  std::string status_;
};

}  // namespace g4_tool
