// SPDX-License-Identifier: MIT
// The one optional thread: reads a lidar, so that nobody has to be in time.
#pragma once

#include <memory>
#include <optional>

#include "g4lidar/error.hpp"
#include "g4lidar/export.hpp"
#include "g4lidar/lidar.hpp"

namespace g4lidar {

/// Reads a lidar in a thread of its own and feeds its ring. *Any thread* may call anything but
/// construction, assignment and destruction. Stopped and destroyed at any moment, in any order, it
/// ends within the time that the device takes to stop, and never hangs.
///
///     auto reader = background_reader::start(std::move(*lidar));
///     auto points = (*reader).points().make_reader();
///     while (running) use(points);
class G4LIDAR_API background_reader {
 public:
  /// Starts the scan, then the thread. Errors: those of lidar::start(), system.
  [[nodiscard]] static result<background_reader> start(lidar&& device);

  background_reader(background_reader&&) noexcept;
  background_reader& operator=(background_reader&&) noexcept;
  /// As stop().
  ~background_reader();

  /// Ends the thread, and stops the motor. Again, it does nothing.
  void stop() noexcept;

  /// Every point; good as long as this reader, however it is moved, and after stop() too.
  [[nodiscard]] lidar_ring& points() noexcept;

  /// Why the thread has ended by itself, if it has: reconnecting is off and the device was lost.
  [[nodiscard]] std::optional<error> failed() const;
  /// Counts, as they were at most 0.1 s ago while points come.
  [[nodiscard]] lidar_counts counts() const;
  /// What happened by itself since the last call, the oldest first.
  [[nodiscard]] std::optional<lidar_event> next_event();

 private:
  struct state;
  explicit background_reader(std::unique_ptr<state> made) noexcept;
  std::unique_ptr<state> state_;
};

}  // namespace g4lidar
