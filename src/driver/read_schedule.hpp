// SPDX-License-Identifier: MIT
// When a read during a scan is worth its system calls.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "g4lidar/core/model.hpp"
#include "g4lidar/core/packet.hpp"
#include "revolution_forecast.hpp"

namespace g4lidar {

/// What the caller waits for.
enum class demand : std::uint8_t {
  points,  ///< Each packet.
  scans,   ///< The end of the revolution.
};

/// *Single thread, never allocates.* A serial port delivers a few bytes at a time, and nothing can
/// be delivered before a packet is complete: until then a reader should sleep.
///
/// The rest of a packet whose header has arrived cannot arrive sooner than its transmission takes.
/// Of the next packet not even the size is known; but devices measure equidistantly and send
/// packets of one size until a revolution ends. So far from that end the next packet is expected
/// when its samples have been measured; near the end, where any packet may complete a scan, a
/// packet of a single sample is expected as soon as it can be transmitted.
///
/// If only scans are wanted, the reader sleeps until the end is near, but never while more than half
/// of what the system keeps can arrive. Just before the end it waits for bytes and does not sleep,
/// because a sleep ends later than a wait for bytes that arrive.
class read_schedule {
 public:
  /// Of a lidar of this model.
  explicit read_schedule(const model& model = g4_model) noexcept
      : which_(&model), serial_byte_ns_(byte_time_ns(model.bauds[0])) {}

  /// Another transport, with so many bits per second. 0: bytes take no time, and every read is
  /// worth it. The system keeps `kept` bytes while nobody reads; 0: not known.
  void reset(std::uint32_t baud, std::size_t kept) noexcept {
    *this = read_schedule(*which_);
    byte_ns_ = baud == 0 ? 0 : byte_time_ns(baud);
    if (baud != 0) serial_byte_ns_ = byte_ns_;
    longest_rest_ns_ =
        static_cast<std::int64_t>(std::min<std::size_t>(kept / 2, 2048)) * serial_byte_ns_;
  }

  /// `count` bytes were read.
  void received(std::size_t count, std::int64_t read_ns) noexcept {
    const std::int64_t took_ns = static_cast<std::int64_t>(count) * serial_byte_ns_;
    ahead_ns_ = std::max(ahead_ns_ + took_ns - (read_ns - read_ns_), -longest_stall_ns);
    ahead_ns_ = std::min(ahead_ns_, 10 * most_ahead_ns);
    read_ns_ = read_ns;
    ++readings_;
    if (unpaced_ > 0) {
      --unpaced_;
    } else {
      next_unpaced_ = 0;
    }
  }

  /// No packet was complete at next_ns(): the bytes were held back. Waits are tried again after
  /// some reads, less often after each failure.
  void nothing_complete() noexcept {
    next_unpaced_ = std::min(2 * next_unpaced_ + 1, most_unpaced);
    unpaced_ = next_unpaced_;
  }

  /// A packet was complete, with `behind` bytes behind it in the last read. Its last sample was
  /// measured at `measured_ns`; `period_ns` is that of the samples.
  void packet(packet_view found, std::size_t behind, std::int64_t measured_ns,
              double period_ns) noexcept {
    const bool as_expected = readings_ == 1 && due_ns_ != 0;
    readings_ = 0;
    std::int64_t arrived_ns = read_ns_ - static_cast<std::int64_t>(behind) * byte_ns_;
    forecast_.packet(found, measured_ns, arrived_ns, period_ns, serial_byte_ns_);
    const std::size_t samples = forecast_.next_samples();
    if (samples == 0) {
      due_ns_ = 0;
      return;
    }
    const auto apart_ns = static_cast<std::int64_t>(static_cast<double>(samples) * period_ns);
    // It may have been available earlier: read a little earlier each time, until a packet is not
    // complete.
    if (as_expected) arrived_ns = std::min(arrived_ns, due_ns_) - apart_ns / 128;
    due_ns_ = arrived_ns + apart_ns;
  }

  /// When to read next, if there is nothing else to do; may have passed. `held` bytes of a packet are
  /// there, and at least `missing` are not.
  [[nodiscard]] std::int64_t next_ns(std::size_t held, std::size_t missing,
                                     demand wanted) const noexcept {
    if (ahead_ns_ > most_ahead_ns) return 0;
    const std::int64_t end_ns = forecast_.end_ns();
    const std::int64_t alert_ns = end_ns - alert_before_ns;
    if (wanted == demand::scans && end_ns != 0 && longest_rest_ns_ > 0) {
      const std::int64_t look_ns = end_ns - look_before_ns;
      const bool is_far = look_ns > read_ns_ + least_rest_ns;
      return std::min(is_far ? look_ns : alert_ns, read_ns_ + longest_rest_ns_);
    }
    if (byte_ns_ == 0 || unpaced_ > 0) return 0;
    const std::int64_t next_ns = packet_ns(held, missing);
    return read_ns_ > end_ns + longest_ns ? next_ns : std::min(next_ns, alert_ns);
  }

 private:
  /// The time of ten bits.
  static constexpr std::int64_t byte_time_ns(std::uint32_t baud) noexcept {
    return 10'000'000'000 / baud;
  }

  static constexpr std::int64_t us = 1'000;
  static constexpr std::int64_t ms = 1'000 * us;
  /// If bytes arrive so far ahead of the baud rate, the baud rate is not valid; but a transport
  /// that stalled may catch up.
  static constexpr std::int64_t most_ahead_ns = 3 * ms;
  static constexpr std::int64_t longest_stall_ns = 200 * ms;
  /// The longest useful sleep.
  static constexpr std::int64_t longest_ns = 10 * ms;
  /// The usual delay of a wake-up; shorter sleeps near a possible end of scan are not worth it.
  static constexpr std::int64_t wake_ns = 100 * us;
  static constexpr std::int64_t least_ns = 300 * us;
  static constexpr int most_unpaced = 63;
  /// So long before the end of a revolution a reading renews the forecast, unless the last reading was
  /// not much before.
  static constexpr std::int64_t look_before_ns = 12 * ms;
  static constexpr std::int64_t least_rest_ns = 6 * ms;
  /// From then on the reader waits for the end.
  static constexpr std::int64_t alert_before_ns = 1'500 * us;

  /// When the rest of a packet that has begun, or the next one, can be complete.
  [[nodiscard]] std::int64_t packet_ns(std::size_t held, std::size_t missing) const noexcept {
    if (held < packet_header_size) {
      missing = std::max(missing, packet_size(1, which_->samples.layout) - held);
    }
    const std::int64_t whole_ns = static_cast<std::int64_t>(missing) * byte_ns_;
    if (due_ns_ == 0) return whole_ns < least_ns ? 0 : read_ns_ + whole_ns - wake_ns;
    const std::int64_t worth_ns = read_ns_ + std::min(whole_ns, longest_ns);
    return readings_ > 0 ? worth_ns : std::clamp(due_ns_, worth_ns, read_ns_ + longest_ns);
  }

  const model* which_;
  std::int64_t byte_ns_ = 0;     // that a byte takes
  std::int64_t serial_byte_ns_;  // the same on the serial line behind a bridge
  std::int64_t longest_rest_ns_ = 0;
  std::int64_t read_ns_ = 0;   // of the last reading
  std::int64_t ahead_ns_ = 0;  // how much sooner bytes arrived than the baud rate allows
  std::int64_t due_ns_ = 0;    // when the next packet is expected to be complete; 0: at any time
  std::size_t readings_ = 0;   // since the last packet
  revolution_forecast forecast_;
  int next_unpaced_ = 0;
  int unpaced_ = 0;  // the number of reads without a wait
};

}  // namespace g4lidar
