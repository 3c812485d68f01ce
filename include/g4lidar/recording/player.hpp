// SPDX-License-Identifier: MIT
// Plays a file: a recording, or the raw bytes of a port.
#pragma once

#include <cstdint>
#include <limits>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"

namespace g4lidar {

/// How a file is played.
struct playback_options {
  /// 1: as fast as it was recorded; 0.5: half as fast; 0: as fast as it is read. 0, or 0.000001 to 1000.
  /// The timeout of a call is by the clock of the caller, at every speed.
  double speed = 0;
  bool loop = false;  ///< Whether it begins again at its end; the times continue.
  /// Only what was recorded from `from_ns` on and before `to_ns`, since its beginning; in each round.
  std::int64_t from_ns = 0;
  std::int64_t to_ns = std::numeric_limits<std::int64_t>::max();
};

/// The player of a lidar that plays a file: see lidar::player(). *Single thread*: that of the lidar.
/// Positions are nanoseconds since the beginning of the file.
class G4LIDAR_API player {
 public:
  virtual ~player() = default;
  player(const player&) = delete;
  player& operator=(const player&) = delete;

  /// While it is paused, nothing is read: a call waits until its timeout, a loop over scans without limit.
  virtual void pause(bool pauses) noexcept = 0;
  /// Whether it is paused.
  [[nodiscard]] virtual bool is_paused() const noexcept = 0;
  /// From now on. Fails with bad_option: see playback_options::speed.
  [[nodiscard]] virtual result<void> set_speed(double speed) noexcept = 0;
  /// See playback_options.
  [[nodiscard]] virtual double speed() const noexcept = 0;
  /// From now on; see playback_options.
  virtual void set_loop(bool loops) noexcept = 0;
  /// Continues at this position; less than 0 and more than the length count as these. Also after the end,
  /// which a lidar that was closed does not undo. The unfinished revolution is dropped, and the times are
  /// those of the recording again; a started scan goes on, and counts continue. Fails with bad_option if the
  /// lidar is recorded, whose times do not go back, and like recording_reader::open().
  [[nodiscard]] virtual result<void> seek(std::int64_t position_ns) noexcept = 0;
  /// Where it is, in the round that is played.
  [[nodiscard]] virtual std::int64_t position_ns() noexcept = 0;
  /// The time of position 0, as a point::time_ns of the round that is played.
  [[nodiscard]] virtual std::int64_t begin_ns() noexcept = 0;
  /// From the first to the last byte, whatever is played of it. Raw bytes are read to their end for it, the
  /// first time.
  [[nodiscard]] virtual std::int64_t length_ns() noexcept = 0;
  /// A point::time_ns by the wall clock when it was recorded, in nanoseconds since 1970. In a loop it
  /// continues, as the times do.
  [[nodiscard]] virtual std::int64_t wall_ns(std::int64_t time_ns) noexcept = 0;

 protected:
  player() = default;
};

}  // namespace g4lidar
