// SPDX-License-Identifier: MIT
// How many samples were lost between two packets, told from the angle that was passed over.
#pragma once

#include <algorithm>
#include <cstdint>

#include "g4lidar/decode.hpp"
#include "g4lidar/packet.hpp"

namespace g4lidar {

/// What stands between a packet and the one before it.
struct sample_gap {
  std::int64_t lost = 0;       ///< Samples that the device measured and that never came.
  double doubt_samples = 0.0;  ///< By how many `lost` may be wrong; 0 where it is surely right.
  bool known = true;           ///< False where the angles cannot tell; `lost` is a guess then.
};

/// Counts lost samples. *Single thread, never allocates.* It learns from the stream how far the
/// motor turns in one sample; a step from packet to packet that is longer has lost samples in it.
/// (protocol: Point packets, FSA and LSA)
class sample_counter {
 public:
  /// The gap before `packet`. `hinted`: bytes were skipped here, so that packets were probably lost.
  /// `late_samples`: by so many the packet is late, if bytes for many samples were skipped; else 0.
  /// It tells whole turns, which angles cannot tell, and only them.
  constexpr sample_gap next(const decoded& packet, bool hinted, double late_samples) noexcept {
    sample_gap gap;
    if (packet.suspect || !following_) {
      gap.known = !hinted;
    } else {
      gap = gap_before(packet, hinted, late_samples);
      if (gap.lost == 0 && gap.known) learn(packet);
    }
    follow(packet);
    return gap;
  }

  /// How far the motor turns in one sample, 1/64 degree; 0 where it is not known, or stands still.
  [[nodiscard]] constexpr double step_64ths() const noexcept { return turning() ? step_ : 0.0; }

  /// Forgets where the last packet ended, and how fast the motor turns.
  constexpr void reset() noexcept { *this = sample_counter(); }

 private:
  static constexpr double turn = turn_64ths;
  /// What turns slower than this, 0.3 Hz at 9 kHz, stands still or is just starting.
  static constexpr double slowest_64ths = 0.75;
  /// By how much of itself the way of one sample may differ from the one learnt.
  static constexpr double step_doubt = 0.001;
  /// And how much more of itself with each lost sample; half a per cent a second is 5e-7.
  static constexpr double step_drift = 4e-7;
  /// More turns than this, a day and longer, are no measurement.
  static constexpr double most_turns = 1e6;

  [[nodiscard]] constexpr bool turning() const noexcept { return step_ > slowest_64ths; }

  /// The way from the last sample to the first one of `packet`, from -1/8 to 7/8 of a turn: real
  /// motors go back a little at times.
  [[nodiscard]] constexpr double way_to(const decoded& packet) const noexcept {
    double way = static_cast<double>(packet.first_angle_64ths) - at_;
    while (way < -turn / 8) way += turn;
    while (way >= turn - turn / 8) way -= turn;
    return way;
  }

  [[nodiscard]] constexpr sample_gap gap_before(const decoded& packet, bool hinted,
                                                double late_samples) const noexcept {
    if (!turning()) return {0, 0.0, !hinted};
    // A motor that spins up makes longer steps than those learnt; without a hint, that is no loss.
    const double step = hinted ? step_ : std::max({step_, own_step_, own_step(packet)});
    const double missed = way_to(packet) / step - 1.0;
    // Without a hint, what the steps between packets do all the time is no loss.
    const double of_turn = turn / step;
    const double least = 0.5 + (hinted ? 0.0 : 4.0 * roughness_);
    if (missed < least && late_samples < of_turn / 2) return {};
    // Late by a little less than the truth, or by as much as bytes are held back.
    const double turns = std::clamp((late_samples - missed) / of_turn + 0.3, 0.0, most_turns);
    const double all = missed + of_turn * static_cast<double>(static_cast<std::int64_t>(turns));
    const double doubt = roughness_ + (step_doubt + step_drift * all) * all;
    return {static_cast<std::int64_t>(all + 0.5), doubt < 0.5 ? 0.0 : doubt, true};
  }

  constexpr void learn(const decoded& packet) noexcept {
    const double way = way_to(packet);
    samples_ += packet.sample_count;
    way_ += way + static_cast<double>(packet.span_64ths);
    if (turning()) {
      const double off = way / step_ - 1.0;
      roughness_ += ((off < 0.0 ? -off : off) - roughness_) * 0.05;
    }
    if (samples_ < 24.0) return;  // too few to divide by
    step_ += (way_ / samples_ - step_) * (step_ == 0.0 ? 1.0 : 0.25);
    way_ = 0.0;
    samples_ = 0.0;
  }

  /// How far the motor turned from sample to sample of a packet; 0 where that is not said.
  [[nodiscard]] static constexpr double own_step(const decoded& packet) noexcept {
    if (packet.suspect || packet.sample_count < 8) return 0.0;  // the rounding of the angles
    return static_cast<double>(packet.span_64ths) / (packet.sample_count - 1);
  }

  constexpr void follow(const decoded& packet) noexcept {
    if (const double own = own_step(packet); own > 0.0) own_step_ = own;
    if (packet.suspect) {
      at_ += step_ * packet.sample_count;
    } else {
      at_ = static_cast<double>(packet.first_angle_64ths) + packet.span_64ths;
      following_ = true;
    }
    while (at_ >= turn) at_ -= turn;
    while (at_ < 0.0) at_ += turn;
  }

  double at_ = 0.0;         // the angle of the last sample, 1/64 degree
  double step_ = 0.0;       // of one sample, 1/64 degree
  double own_step_ = 0.0;   // of the last packet that was long enough to tell
  double way_ = 0.0;        // gone since `step_` was last brought up to date
  double samples_ = 0.0;    // in that way
  double roughness_ = 0.1;  // of the steps between packets, in samples
  bool following_ = false;  // `at_` is known
};

}  // namespace g4lidar
