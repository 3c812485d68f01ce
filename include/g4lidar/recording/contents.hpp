// SPDX-License-Identifier: MIT
// What a recording contains besides bytes: its lidar, the events of the connection, and digests.
#pragma once

#include <algorithm>
#include <bit>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/request.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/settings.hpp"
#include "g4lidar/transport/recognition.hpp"

namespace g4lidar {

/// Models, by their places in `models`.
using model_set = std::bitset<models.size()>;
/// *Pure.*
[[nodiscard]] inline model_set set_of(std::span<const model* const> of) noexcept {
  model_set all;
  for (std::size_t at = 0; at < models.size(); ++at) {
    all[at] = std::find(of.begin(), of.end(), &models[at]) != of.end();
  }
  return all;
}

/// What is known about the recorded lidar: a metadata record of each file, "g4lidar.device".
/// Settings that were not queried are not known.
struct recorded_device {
  device_information information{};
  std::optional<g4lidar::sample_rate> sample_rate{};
  std::optional<scan_frequency> frequency{};
  std::optional<motor_direction> motor{};
  std::optional<constant_frequency> constant{};
  std::optional<low_power> idle{};
  std::optional<power_down_protection> protection{};
  /// As which model the lidar was read, if that was a guess, or something contradicts it: contradictions_of(). Its
  /// candidates are below. The driver records it; a device() without it leaves it as it is.
  std::optional<recognition> recognised{};
  /// Of `recognised`: the models between which the bytes did not decide.
  model_set candidates{};

  /// The model of `recognised`, at last. Null: it is not recorded. Valid forever.
  [[nodiscard]] const model* read_as() const noexcept {
    return recognised ? recognised->model : nullptr;
  }
};

/// The direction of bytes.
enum class direction : std::uint8_t { from_device, to_device };

/// FNV-1a over the bytes of a connection and their directions, in order, however the reads were
/// divided. *Single thread, never allocates, never waits.*
class payload_digest {
 public:
  /// Adds bytes of that direction.
  constexpr void add(direction direction, bytes data) noexcept {
    if (data.empty()) return;
    if (is_first_ || direction != way_) mix(0x100U + static_cast<unsigned>(direction));
    is_first_ = false;
    way_ = direction;
    for (const std::uint8_t byte : data) mix(byte);
  }
  /// The digest of everything so far.
  [[nodiscard]] constexpr std::uint64_t value() const noexcept { return hash_; }

 private:
  constexpr void mix(unsigned symbol) noexcept { hash_ = (hash_ ^ symbol) * 0x100000001B3U; }

  std::uint64_t hash_ = 0xCBF29CE484222325U;
  direction way_ = direction::from_device;
  bool is_first_ = true;
};

/// The same for points, in words of 32 bits: all their members, including the times. The last bits
/// may depend on the architecture: see computed_with().
class point_digest {
 public:
  /// Adds points, in order.
  constexpr void add(std::span<const point> points) noexcept {
    for (const point& p : points) {
      mix(std::bit_cast<std::uint32_t>(p.angle_deg));
      mix(std::bit_cast<std::uint32_t>(p.range_mm));
      mix(static_cast<std::uint32_t>(static_cast<std::uint64_t>(p.time_ns)));
      mix(static_cast<std::uint32_t>(static_cast<std::uint64_t>(p.time_ns) >> 32U));
      mix(p.revolution);
      // A model without sample flags and intensity has 0 there: the digests of a G4's points are those
      // from before points had them, so the version of the computation is the same.
      mix(static_cast<std::uint32_t>(p.flags) | std::uint32_t{p.sample_flags} << 8U |
          std::uint32_t{p.intensity} << 16U);
    }
    count_ += points.size();
  }
  /// The digest of everything so far.
  [[nodiscard]] constexpr std::uint64_t value() const noexcept { return hash_; }
  /// The number of points.
  [[nodiscard]] constexpr std::uint64_t count() const noexcept { return count_; }

 private:
  // One word at a time: 24 single bytes would cost more than decoding the point.
  constexpr void mix(std::uint32_t word) noexcept { hash_ = (hash_ ^ word) * 0x100000001B3U; }

  std::uint64_t hash_ = 0xCBF29CE484222325U;
  std::uint64_t count_ = 0;
};

/// The digests that a closed recording contains: of the payload of each file, and of the points if
/// there is only one file.
struct recorded_digest {
  std::uint64_t payload = 0;
  std::uint64_t points = 0;
  std::uint64_t point_count = 0;  ///< 0: the writer received no points.
  bool is_same_version = true;    ///< Whether this version of the library computes the same points.
  bool is_comparable = true;  ///< Whether points computed on this machine have the same last bits.
};

/// The architecture that points are computed with on this machine, "x86_64". If it differs,
/// the last bits of angles and times may differ, and digests of points cannot be compared. Valid
/// forever.
[[nodiscard]] G4LIDAR_API std::string_view computed_with() noexcept;

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
