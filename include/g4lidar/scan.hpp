// SPDX-License-Identifier: MIT
// One revolution as a view of its points, with its flags.
#pragma once

#if __STDC_HOSTED__
#include <chrono>
#endif
#include <cstddef>
#include <cstdint>
#include <span>

#include "g4lidar/core/model.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/point.hpp"

namespace g4lidar {

/// The sample rate of a G4 with its default settings, in Hz. (protocol: Commands)
inline constexpr std::uint32_t default_sample_rate_hz = g4_model.rates.nominal_hz;

/// Why a scan is not one whole revolution between two zero packets; a set of bits.
enum class scan_flags : std::uint8_t {
  none = 0,
  start_missing =
      1,  ///< Begins within a revolution: at the start of the stream, or where the storage was full.
  end_missing =
      2,  ///< Ends within a revolution: at the end of the stream, or because the storage was full.
  data_lost = 4,   ///< Bytes were lost, or a suspect packet was left out, between its points.
  turn_short = 8,  ///< The zero packet at its end came well before a full turn of the angle.
  start_by_angle =
      16,  ///< Its zero packet was lost: it begins where the angle passes the last zero angle.
  end_by_angle = 32,  ///< The next zero packet was lost: it ends at the zero angle.
  crc_mismatch = 64,  ///< A packet was lost by the CRC byte of devices that send one; see ct_check.
};

/// All flags of both. *Pure.*
[[nodiscard]] constexpr scan_flags operator|(scan_flags a, scan_flags b) noexcept {
  return static_cast<scan_flags>(static_cast<unsigned>(a) | static_cast<unsigned>(b));
}
/// The flags that both contain. *Pure.*
[[nodiscard]] constexpr scan_flags operator&(scan_flags a, scan_flags b) noexcept {
  return static_cast<scan_flags>(static_cast<unsigned>(a) & static_cast<unsigned>(b));
}

/// One revolution, or a piece of one: a range of points. A view: `points` is in the storage of the
/// assembler. g4lidar::owned_scan is a copy to keep. In a frame of reference: to_xy(scan,
/// frame::robot, out) of cartesian.hpp, and bearing_deg(angle, frame::robot, scan.model->turn_deg)
/// of point.hpp for the angle of a point.
struct scan {
  std::span<const point> points;  ///< In the order in which they were measured.
  /// The number of zero packets before it; scans that were cut by the angle have the same number.
  std::uint32_t revolution = 0;
  scan_flags flags = scan_flags::none;
  /// The rotation frequency that the device reported with this revolution, 0.01 Hz; 0 if it did not.
  std::uint16_t reported_frequency_chz = 0;
  std::uint32_t suspect_packets = 0;  ///< Left out of `points`, and flagged as `data_lost`.
  std::uint32_t suspect_samples = 0;  ///< The samples of these packets.
  std::uint32_t sample_rate_hz =
      default_sample_rate_hz;  ///< The configured sample rate of the device.
  /// The model of the lidar, with the turn to the robot's frame. Never null; valid at
  /// least as long as the scan.
  const g4lidar::model* model = &g4_model;
  /// The change of the first-level angle, clockwise degrees, from the first point to the first one
  /// of the next scan (or to the last point, where the stream ended): about 360 for a revolution.
  float turned_deg = 0.0F;
  /// The time for that turn, if the times of both points are known; else 0.
  std::int64_t duration_ns = 0;

  /// The points as a range, in the order in which they were measured.
  [[nodiscard]] constexpr auto begin() const noexcept { return points.begin(); }
  /// The same.
  [[nodiscard]] constexpr auto end() const noexcept { return points.end(); }
  /// The same.
  [[nodiscard]] constexpr const point* data() const noexcept { return points.data(); }
  /// The number of points.
  [[nodiscard]] constexpr std::size_t size() const noexcept { return points.size(); }
  /// Whether there is no point.
  [[nodiscard]] constexpr bool empty() const noexcept { return points.empty(); }
  /// Point `i`, below size().
  [[nodiscard]] constexpr const point& operator[](std::size_t i) const noexcept {
    return points[i];
  }

  /// Whether this is one revolution from zero packet to zero packet without known loss.
  [[nodiscard]] constexpr bool is_whole() const noexcept { return flags == scan_flags::none; }
  /// Whether is_whole() is false.
  [[nodiscard]] constexpr bool is_partial() const noexcept { return !is_whole(); }
  /// Whether it is only a part of a turn: at the start or the end of a stream, with a motor that
  /// does not turn, or because it exceeds the storage. All other scans are revolutions, although
  /// data may be lost.
  [[nodiscard]] constexpr bool is_piece() const noexcept {
    return has(scan_flags::start_missing | scan_flags::end_missing | scan_flags::turn_short);
  }
  /// Whether it has `flag`, or at least one of several flags.
  [[nodiscard]] constexpr bool has(scan_flags flag) const noexcept {
    return (flags & flag) != scan_flags::none;
  }

  /// When its first point was measured, in nanoseconds of the monotonic clock; 0 if not known.
  [[nodiscard]] constexpr std::int64_t time_ns() const noexcept {
    return empty() ? 0 : points.front().time_ns;
  }
#if __STDC_HOSTED__
  /// The same as a time of the monotonic clock; the epoch if it is not known.
  [[nodiscard]] constexpr std::chrono::steady_clock::time_point time() const noexcept {
    return std::chrono::steady_clock::time_point(std::chrono::nanoseconds(time_ns()));
  }
#endif
  /// When the next scan began; if there is none, when the last point was measured.
  [[nodiscard]] constexpr std::int64_t end_ns() const noexcept {
    if (empty()) return 0;
    return duration_ns > 0 ? detail::saturating_add(time_ns(), duration_ns) : points.back().time_ns;
  }
#if __STDC_HOSTED__
  /// The same as a time of the monotonic clock; the epoch if it is not known.
  [[nodiscard]] constexpr std::chrono::steady_clock::time_point end_time() const noexcept {
    return std::chrono::steady_clock::time_point(std::chrono::nanoseconds(end_ns()));
  }
#endif
  /// Samples per second, from the times of its points; the nominal rate if these are not
  /// sufficient.
  [[nodiscard]] constexpr float measured_sample_rate_hz() const noexcept {
    const std::int64_t taken =
        size() < 2 ? 0 : detail::saturating_sub(points.back().time_ns, time_ns());
    if (taken <= 0 || has(scan_flags::data_lost | scan_flags::crc_mismatch))
      return static_cast<float>(sample_rate_hz);
    return static_cast<float>(size() - 1) * 1e9F / static_cast<float>(taken);
  }
  /// The measured rotation frequency in Hz: turns by time if the times are known, else turns by
  /// samples at the nominal rate. 0 if it cannot be determined.
  [[nodiscard]] constexpr float measured_frequency_hz() const noexcept {
    const float turns = turned_deg / 360.0F;
    if (duration_ns > 0) return turns * 1e9F / static_cast<float>(duration_ns);
    if (empty() || has(scan_flags::data_lost | scan_flags::crc_mismatch | scan_flags::end_missing))
      return 0.0F;
    return turns * static_cast<float>(sample_rate_hz) / static_cast<float>(size());
  }
};

/// Writes all points of a scan in frame `to`, turned as its model, to the front of `out`, which is at
/// least as long, and returns what was written. *Pure.*
constexpr std::span<polar> to_polar(const scan& source, frame to, std::span<polar> out) noexcept {
  return to_polar(source.points, to, out, source.model->turn_deg);
}

}  // namespace g4lidar

// A scan is a view: its iterators outlive it.
template <>
inline constexpr bool std::ranges::enable_borrowed_range<g4lidar::scan> = true;
