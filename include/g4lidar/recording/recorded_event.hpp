// SPDX-License-Identifier: MIT
// The events of a connection that a recording contains in addition to the received bytes, for
// replay.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/settings.hpp"

namespace g4lidar {

class connector;
struct recorded_device;
struct recognition;

/// One event between two reads of a transport. A view; the function that returns it defines its
/// lifetime.
///
/// A driver that reads a recording processes its bytes like the recorded driver, at the same
/// places, so that the same points result. A place is defined by what had been made of the last
/// read: `events` were taken from it, and `unparsed` of its bytes were left.
struct recorded_event {
  /// The kinds of event.
  enum class kind : std::uint8_t {
    opened,  ///< The transport was opened, the first time or again: `name`, `baud`.
    closed,  ///< The transport was closed, or the connection broke: `reason`.
    sent,    ///< `data` was sent to the device.
    begun,   ///< The following points begin a new stream: `sample_rate_hz`, `delivers`.
    held,    ///< From here on packets produce no points, until the next `begun`.
    cut,  ///< The unparsed bytes were discarded, and a held packet was parsed again from its second byte.
    gap,       ///< Bytes are missing from the recording at this place.
    state,     ///< The current state, repeated for readers that begin here: all of the above.
    odometry,  ///< The robot's `odometry`, which is recorded beside the bytes.
    dtr_low,   ///< The line DTR, which drives the motor of the model, was set to low.
    dtr_high,  ///< The same, to high.
  };
  kind what;
  problem reason = problem::cancelled;  ///< Of `closed`; cancelled: no error.
  bool delivers = true;                 ///< Whether packets produce points from here on.
  std::uint32_t baud = 0;               ///< See transport::baud().
  std::uint32_t sample_rate_hz = 0;     ///< The nominal sample rate.
  std::uint32_t unparsed = 0;           ///< Bytes of the last read.
  std::uint32_t events = 0;             ///< Of the parser, since the last read.
  std::int64_t time_ns = 0;             ///< By the clock of the transport.
  std::string_view name{};              ///< transport::name(), of `opened` and `state`.
  bytes data{};                         ///< Of `sent`.
  stamped_odometry odometry{};          ///< Of `odometry`.
  /// What is added to each angle, of `begun`, `held`, `cut` and `state`; nothing: not known.
  std::optional<zero_angle> zero{};
  /// Of `begun` and `state`: the times of points are counted from samples at `sample_rate_hz`, as those of raw bytes.
  bool counts_times = false;
};

/// The names in tools and documents. Valid forever.
[[nodiscard]] G4LIDAR_API std::string_view name_of(recorded_event::kind what) noexcept;

/// The events that were recorded with the bytes, for the driver that replays them.
class G4LIDAR_API recorded_event_source {
 public:
  virtual ~recorded_event_source() = default;
  recorded_event_source(const recorded_event_source&) = delete;
  recorded_event_source& operator=(const recorded_event_source&) = delete;

  /// The next event between the last read and the next one: call it until it returns nothing. Valid
  /// until the next call of any function of the recording.
  [[nodiscard]] virtual std::optional<recorded_event> next_event() noexcept = 0;
  /// What is known about the recorded lidar. Valid as long as this.
  [[nodiscard]] virtual const recorded_device& device() const noexcept = 0;
  /// The clock of the timeouts of calls: that of the caller. While the file is read as fast as possible,
  /// the times of the recording pass instead. Continues whatever the player does.
  [[nodiscard]] virtual std::int64_t caller_ns() const noexcept = 0;
  /// The end of a call that waits this long, by caller_ns().
  [[nodiscard]] virtual std::int64_t deadline_after_ns(std::int64_t timeout_ns) const noexcept = 0;
  /// Such an end by the clock of the recording, at its speed of now.
  [[nodiscard]] virtual std::int64_t recorded_ns(std::int64_t deadline_ns) const noexcept = 0;
  /// How long the caller has to wait for the next read, by its own clock. 0 if it has arrived, or
  /// if there is none.
  [[nodiscard]] virtual std::int64_t wait_for_next_ns() noexcept = 0;
  /// Whether next_event() or a read ended early, because of a wake-up or
  /// reading_options::is_cancelled. Resets it.
  [[nodiscard]] virtual bool take_cancelled() noexcept = 0;

 protected:
  recorded_event_source() = default;
};

/// The second base class of a connector that plays a recording, or whose transports are recorded.
class G4LIDAR_API recording_hook {
 public:
  virtual ~recording_hook() = default;
  recording_hook(const recording_hook&) = delete;
  recording_hook& operator=(const recording_hook&) = delete;

  /// The events that were recorded with the bytes of the transports; null if there are none.
  [[nodiscard]] virtual recorded_event_source* events() noexcept { return nullptr; }
  /// To be recorded: an event of the driver, after the last read and before the next one.
  virtual void event(const recorded_event& /*what*/) noexcept {}
  /// To be recorded: the model as which the lidar is read is guessed, or something contradicts it.
  virtual void recognised(const recognition& /*what*/) noexcept {}

 protected:
  recording_hook() = default;
};

/// That of the connector, or of the nearest one that it wraps; null if nothing is played or recorded.
/// Valid as long as the connector.
[[nodiscard]] G4LIDAR_API recording_hook* recording_hook_of(connector& from) noexcept;

}  // namespace g4lidar
