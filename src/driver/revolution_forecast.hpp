// SPDX-License-Identifier: MIT
// When the revolution that is being measured will end.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "g4lidar/core/model.hpp"
#include "g4lidar/core/packet.hpp"

namespace g4lidar {

/// *Single thread, never allocates.* The end follows from the angle of the last packet, the angle of the
/// last zero packet and the speed of the motor, which the angles of a packet give. What the device and
/// the transport add is learned from the revolutions before: the least of it, because a bridge may hold
/// bytes back.
class revolution_forecast {
 public:
  /// A packet whose last sample was measured at `measured_ns`, and whose last byte arrived at `complete_ns`.
  /// `period_ns` is that of the samples, `byte_ns` that of the bytes on the serial line.
  void packet(packet_view found, std::int64_t measured_ns, std::int64_t complete_ns,
              double period_ns, std::int64_t byte_ns) noexcept {
    if (found.is_zero()) {
      learn(complete_ns);
      zero_64ths_ = found.first_angle_64ths();
      left_64ths_ = turn_64ths;
      last_ = before_;  // the packet before was cut off
      unsure_ = 0;
    } else {
      before_ = std::exchange(last_, found.sample_count());
      follow(found);
    }
    const std::size_t full = std::max(last_, before_);
    if (!found.is_zero() && found.sample_count() < full) return;  // cut off: the end stays the same
    const bool is_known = zero_64ths_ >= 0 && unsure_ == 0 && is_steady_;
    from_ = {.full = is_known ? full : 0,
             .samples = found.sample_count(),
             .layout = found.layout(),
             .left_64ths = left_64ths_,
             .measured_ns = measured_ns,
             .byte_ns = byte_ns,
             .period_ns = period_ns};
  }

  /// When the zero packet is expected to be complete, at the earliest; 0: not known.
  [[nodiscard]] std::int64_t end_ns() const noexcept {
    return from_.full == 0 ? 0 : forecast_ns() + late_ns_;
  }
  /// How many samples the next packet will have; 0 where the revolution may end with it.
  [[nodiscard]] std::size_t next_samples() const noexcept {
    // A motor that spins up goes further with each packet.
    const bool is_far =
        zero_64ths_ >= 0 && unsure_ == 0 && span_64ths_ > 0 && left_64ths_ > 2 * span_64ths_;
    return is_far ? std::min(last_, before_) : 0;
  }

 private:
  /// Packets of fewer samples do not give the speed.
  static constexpr std::size_t enough_samples = 8;
  /// So many packets after the last zero angle the zero packet has been lost.
  static constexpr int packets_until_lost = 3;
  static constexpr std::int64_t most_late_ns = 20'000'000;

  /// What the forecast is made from: the last full packet, or the zero packet.
  struct origin {
    std::size_t full = 0;  // samples of a full packet; 0: there is no forecast
    std::size_t samples = 0;
    sample_layout layout = g4_layout;
    int left_64ths = 0;
    std::int64_t measured_ns = 0;
    std::int64_t byte_ns = 0;
    double period_ns = 0.0;
  };

  /// Full packets, one that is cut off, and the zero packet: each when it is measured and the serial line is
  /// free.
  [[nodiscard]] std::int64_t forecast_ns() const noexcept {
    const auto sent_ns = [&](std::size_t samples) {
      const auto size = static_cast<std::int64_t>(packet_size(samples, from_.layout));
      return samples == 0 ? 0 : size * from_.byte_ns;
    };
    const auto after_ns = [&](std::size_t samples) {
      return from_.measured_ns +
             static_cast<std::int64_t>(static_cast<double>(samples) * from_.period_ns);
    };
    const auto left = static_cast<std::size_t>(samples_per_64th_ * from_.left_64ths);
    const std::size_t rest = left % from_.full;
    const std::int64_t free_ns = left < from_.full ? after_ns(0) + sent_ns(from_.samples)
                                                   : after_ns(left - rest) + sent_ns(from_.full);
    return std::max(after_ns(left), free_ns) + sent_ns(rest) + sent_ns(1);
  }
  void follow(packet_view found) noexcept {
    span_64ths_ = found.sample_count() < 2 ? 0 : found.span_64ths();
    if (found.sample_count() >= enough_samples && span_64ths_ > 0) {
      const double speed = static_cast<double>(found.sample_count() - 1) / span_64ths_;
      const double change = speed - std::exchange(samples_per_64th_, speed);
      is_steady_ = change < speed / 16 && -change < speed / 16;
    }
    int left = zero_64ths_ - found.last_angle_64ths();
    if (left < 0) left += turn_64ths;
    const bool has_passed = left > std::exchange(left_64ths_, left);
    unsure_ = has_passed ? packets_until_lost : std::max(unsure_ - 1, 0);
  }
  void learn(std::int64_t complete_ns) noexcept {
    if (from_.full == 0) return;
    const std::int64_t late_ns = complete_ns - forecast_ns();
    if (late_ns < -most_late_ns || late_ns > most_late_ns) return;
    late_ns_ = late_ns < late_ns_ ? late_ns : late_ns_ + (late_ns - late_ns_) / 64;
  }

  std::size_t last_ = 0;  // samples of packets
  std::size_t before_ = 0;
  double samples_per_64th_ = 0.0;
  bool is_steady_ = false;
  int span_64ths_ = 0;   // of the last packet
  int zero_64ths_ = -1;  // the angle at which the last revolution ended
  int left_64ths_ = turn_64ths;
  int unsure_ = 0;  // packets since the zero angle without a zero packet, counted down
  origin from_;
  std::int64_t late_ns_ = 0;
};

}  // namespace g4lidar
