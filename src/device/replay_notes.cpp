// SPDX-License-Identifier: MIT
// Recordings: what the driver tells a line of what it does, and does again when that is played.
#include <utility>

#include "driver.hpp"
#include "g4lidar/recorded_device.hpp"

namespace g4lidar {

/// For a line that is recorded. A place is told by what is left of the last reading, and by how many
/// events came out of it: both are the same when the same reading is read again.
void lidar::driver::note(line_note::kind what) {
  if (line_ == nullptr || !line_->answers()) return;
  line_note told{.what = what, .time_ns = now_ns()};
  told.delivers = delivers_;
  told.baud = line_->baud();
  told.samples_per_second = samples_per_second_;
  told.unparsed = static_cast<std::uint32_t>(input_.size());
  told.events = events_of_reading_;
  line_->note(told);
}

void lidar::driver::begin_replay() {
  is_replay_ = false;
  is_played_ = true;
  is_replay_lost_ = false;
  noted_.reset();
  const recorded_device* const device = line_->recorded();
  if (device == nullptr) return;
  is_replay_ = true;
  information_ = device->information;
  if (device->ranging) samples_per_second_ = samples_per_second(*device->ranging);
  play_notes(true);
}

/// Whether this was when just so much of the reading had been taken.
bool lidar::driver::is_here(const line_note& what) const noexcept {
  switch (what.what) {
    case line_note::kind::begun:
    case line_note::kind::held:
    case line_note::kind::cut:
      return input_.size() <= what.unparsed && events_of_reading_ >= what.events;
    case line_note::kind::sent:
    case line_note::kind::state:
      return true;  // no matter where
    case line_note::kind::opened:
    case line_note::kind::closed:
    case line_note::kind::gap:
      break;
  }
  return false;  // when all of it has been taken
}

/// Does what was done at this place when it was recorded; or all that was done until the next reading.
void lidar::driver::play_notes(bool all) {
  if (!is_replay_ || line_ == nullptr) return;
  while (true) {
    if (!noted_) noted_ = line_->noted();
    if (!noted_) return;
    if (!all && !is_here(*noted_)) return;
    const line_note what = *noted_;
    noted_.reset();
    play(what);
  }
}

void lidar::driver::play(const line_note& what) {
  switch (what.what) {
    case line_note::kind::opened:
      stream_.follow(what.baud);
      is_played_ = true;  // a driver says otherwise at once
      if (!std::exchange(is_replay_lost_, false)) return;
      ++reconnects_;
      return tell(lidar_event::kind::reconnected);
    case line_note::kind::closed:
      cut_off();
      is_played_ = false;
      if (what.reason == problem::cancelled) return;
      is_replay_lost_ = true;
      return tell(lidar_event::kind::lost, what.reason);
    case line_note::kind::begun:
      is_played_ = what.delivers;
      samples_per_second_ = what.samples_per_second;
      return stream_.begin(samples_per_second_);
    case line_note::kind::held:
      is_played_ = false;
      return;
    case line_note::kind::cut:
      return cut_off();
    case line_note::kind::gap:
      cut_off();
      return stream_.begin(samples_per_second_);
    case line_note::kind::state:
      return play_state(what);
    case line_note::kind::sent:
      return;
  }
}

/// Told at the beginning, and again and again: most often it is so already.
void lidar::driver::play_state(const line_note& what) {
  stream_.follow(what.baud);
  is_played_ = what.delivers;
  const std::uint32_t rate = what.samples_per_second;
  if (rate == 0 || rate == samples_per_second_) return;
  samples_per_second_ = rate;
  stream_.begin(rate);
}

}  // namespace g4lidar
