// SPDX-License-Identifier: MIT
// When a reading of a running scan is worth its system calls.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "g4lidar/packet.hpp"

namespace g4lidar {

/// *Single thread, never allocates.* A serial line brings a few bytes at a time, and nothing can be
/// handed over before a packet is complete: until then a reader had better sleep.
///
/// Of a packet whose header is there, the line cannot bring the rest sooner than it takes to send it.
/// Of the next one not even the size is known; but devices measure equidistantly and send packets of
/// one size until a revolution ends. So far from that end the next packet is expected as long after
/// the last one as its samples take to be measured; and near it, where a scan may end with any packet,
/// one of a single sample as soon as the line could bring it.
class read_pace {
 public:
  /// Another line, of so many bits a second. 0: bytes take no time, and any reading is worth it.
  void reset(std::uint32_t baud) noexcept {
    *this = read_pace();
    byte_ns_ = baud == 0 ? 0 : 10'000'000'000 / baud;
  }

  /// `count` bytes were read.
  void came(std::size_t count, std::int64_t read_ns) noexcept {
    const std::int64_t took_ns = static_cast<std::int64_t>(count) * byte_ns_;
    ahead_ns_ = std::max(ahead_ns_ + took_ns - (read_ns - read_ns_), -longest_stall_ns);
    ahead_ns_ = std::min(ahead_ns_, 10 * most_ahead_ns);
    read_ns_ = read_ns;
    ++readings_;
    if (unpaced_ > 0) {
      --unpaced_;
    } else {
      vain_ = 0;
    }
  }

  /// Nothing had come by next_ns(): what the line holds back it will give by itself. Tried again
  /// after some readings, the more the more often it was in vain.
  void in_vain() noexcept {
    vain_ = std::min(2 * vain_ + 1, most_unpaced);
    unpaced_ = vain_;
  }

  /// A packet was complete, with `behind` bytes behind it in the last reading. `period_ns` is that of
  /// the samples.
  void packet(packet_view found, std::size_t behind, double period_ns) noexcept {
    const bool as_expected = readings_ == 1 && due_ns_ != 0;
    readings_ = 0;
    const std::size_t samples = next_samples(found);
    if (samples == 0) {
      due_ns_ = 0;
      return;
    }
    const auto apart_ns = static_cast<std::int64_t>(static_cast<double>(samples) * period_ns);
    std::int64_t came_ns = read_ns_ - static_cast<std::int64_t>(behind) * byte_ns_;
    // It may have been there for a while: a little earlier each time, until one is not complete.
    if (as_expected) came_ns = std::min(came_ns, due_ns_) - apart_ns / 128;
    due_ns_ = came_ns + apart_ns;
  }

  /// When to read next, if there is nothing else to do; may have passed. `held` bytes of a packet are
  /// there, and at least `missing` are not.
  [[nodiscard]] std::int64_t next_ns(std::size_t held, std::size_t missing) const noexcept {
    if (byte_ns_ == 0 || unpaced_ > 0 || ahead_ns_ > most_ahead_ns) return 0;
    if (held < packet_header_size) missing = std::max(missing, packet_size(1) - held);
    const std::int64_t whole_ns = static_cast<std::int64_t>(missing) * byte_ns_;
    if (due_ns_ == 0) return whole_ns < least_ns ? 0 : read_ns_ + whole_ns - wake_ns;
    const std::int64_t worth_ns = read_ns_ + std::min(whole_ns, longest_ns);
    return readings_ > 0 ? worth_ns : std::clamp(due_ns_, worth_ns, read_ns_ + longest_ns);
  }

 private:
  static constexpr std::int64_t us = 1'000;
  static constexpr std::int64_t ms = 1'000 * us;
  /// A line that brings bytes so far ahead of its rate is none of that rate; but one that has stood
  /// still may catch up.
  static constexpr std::int64_t most_ahead_ns = 3 * ms;
  static constexpr std::int64_t longest_stall_ns = 200 * ms;
  /// Nobody need sleep longer.
  static constexpr std::int64_t longest_ns = 10 * ms;
  /// Who sleeps wakes up late by so much; where that matters, a shorter sleep is not worth it.
  static constexpr std::int64_t wake_ns = 100 * us;
  static constexpr std::int64_t least_ns = 300 * us;
  static constexpr int most_unpaced = 63;

  /// How many samples the packet after `last` will have; 0 where a revolution may end with it.
  [[nodiscard]] std::size_t next_samples(packet_view last) noexcept {
    const std::size_t samples = last.sample_count();
    int left = turn_64ths;
    if (last.is_zero()) {
      zero_64ths_ = last.first_angle_64ths();
      last_ = before_;  // the packet before was cut off
    } else {
      before_ = std::exchange(last_, samples);
      packet_64ths_ = samples < 2 ? 0 : last.span_64ths();
      left = zero_64ths_ - last.last_angle_64ths();
      if (left < 0) left += turn_64ths;
    }
    // A motor that spins up goes further with each packet.
    const bool is_far = zero_64ths_ >= 0 && packet_64ths_ > 0 && left > 2 * packet_64ths_;
    return is_far ? std::min(last_, before_) : 0;
  }

  std::int64_t byte_ns_ = 0;   // that a byte takes
  std::int64_t read_ns_ = 0;   // of the last reading
  std::int64_t ahead_ns_ = 0;  // how much sooner bytes came than the line could have brought them
  std::int64_t due_ns_ = 0;    // when the next packet is expected to be complete; 0: at any time
  std::size_t readings_ = 0;   // since the last packet
  std::size_t last_ = 0;       // samples of packets
  std::size_t before_ = 0;
  int packet_64ths_ = 0;  // that the motor turned in the last packet
  int zero_64ths_ = -1;   // the angle at which the last revolution ended
  int vain_ = 0;
  int unpaced_ = 0;  // readings to go without
};

}  // namespace g4lidar
