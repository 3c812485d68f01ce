// SPDX-License-Identifier: MIT
// An optional thread that reads a lidar, so that the application need not call the lidar in time.
#pragma once

#include <memory>
#include <optional>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/lidar.hpp"

namespace g4lidar {

/// Reads a lidar in a thread of its own and provides its scans and points. *Any thread* may call
/// any function except construction, assignment and destruction; only one thread at a time may call
/// next_scan(). *Allocates on open.* A moved-from reader behaves like a stopped one.
///
///     auto reader = background_reader::start(std::move(*lidar));
///     while (running) {
///       auto scan = reader->next_scan(500ms);
///       if (scan) use(*scan);
///       else if (scan.error().is_fatal()) return report(scan.error());
///     }
class G4LIDAR_API background_reader {
 public:
  /// Starts the scan, then the thread. Blocks at most as long as lidar::start(); if it fails, the
  /// lidar is closed, which may also take as long as lidar::close(). Errors: those of
  /// lidar::start(), and system.
  [[nodiscard]] static result<background_reader> start(lidar&& device);

  background_reader(background_reader&&) noexcept;
  background_reader& operator=(background_reader&&) noexcept;
  /// Like stop().
  ~background_reader();

  /// Wakes and ends the thread, and stops the motor. Blocks at most as long as lidar::stop(). A
  /// second call does nothing.
  void stop() noexcept;

  /// The oldest scan that was not taken yet, with its flags; valid until the next call of
  /// next_scan(). The last four scans are kept; older ones are dropped and counted as
  /// `scans_missed`. Errors: timeout, with the details of lidar::next_scan(); if the thread has ended, the error of failed(); after stop(),
  /// not_scanning.
  [[nodiscard]] view_result<scan> next_scan(lidar::milliseconds timeout);

  /// Every point. Valid as long as this reader, also after a move and after stop().
  [[nodiscard]] const lidar_ring& points() const noexcept;

  /// Why the thread ended by itself (the device was lost and reconnecting is off); nothing
  /// otherwise.
  [[nodiscard]] std::optional<error> failed() const;
  /// The counts; at most 0.1 s old while points arrive.
  [[nodiscard]] lidar_counts counts() const;
  /// The oldest event that was not taken yet; nothing if there is none.
  [[nodiscard]] std::optional<lidar_event> next_event();

 private:
  struct state;
  explicit background_reader(std::unique_ptr<state> made) noexcept;
  std::unique_ptr<state> state_;
};

}  // namespace g4lidar
