// SPDX-License-Identifier: MIT
// How many samples were lost between two packets: by the angle between them, and by packets that stay late.
#pragma once

#include <algorithm>
#include <cstdint>

#include "g4lidar/core/decode.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/detail/saturating.hpp"

namespace g4lidar {

/// The gap between a packet and the previous one.
struct sample_gap {
  std::int64_t lost = 0;       ///< Samples that the device measured and that never arrived.
  double doubt_samples = 0.0;  ///< The greatest error of `lost`; 0 if it is exact.
  bool known = true;  ///< False if the angles are not sufficient; then `lost` is an estimate.
};

/// Counts lost samples. *Single thread, never allocates.* It learns from the stream how far the
/// motor turns per sample; a longer step from packet to packet contains lost samples. (protocol:
/// Point packets, FSA and LSA)
class sample_counter {
 public:
  /// The gap before `packet`. `hinted`: bytes were skipped here, so that packets were probably
  /// lost. `late_samples`: the delay of the packet in samples, if bytes for many samples were
  /// skipped; else 0. It is used only for whole turns, which angles cannot show.
  constexpr sample_gap next(const decoded& packet, bool hinted, double late_samples) noexcept {
    sample_gap gap;
    const double own = own_step(packet);
    if (packet.suspect || !following_) {
      gap.known = !hinted;
    } else {
      const double way = way_to(packet);
      gap = gap_before(way, own, hinted, late_samples);
      if (gap.lost == 0 && gap.known) learn(packet, way);
    }
    follow(packet, own);
    return gap;
  }

  /// The turn of the motor per sample, 1/64 degree; 0 if it is not known, or the motor does not
  /// turn.
  [[nodiscard]] constexpr double step_64ths() const noexcept { return turning() ? step_ : 0.0; }

  /// Forgets the end of the last packet and the speed of the motor.
  constexpr void reset() noexcept { *this = sample_counter(); }

 private:
  static constexpr double turn = turn_64ths;
  /// A slower motor than this, 0.3 Hz at 9 kHz, is stopped or is just starting.
  static constexpr double slowest_64ths = 0.75;
  /// The relative tolerance for the turn per sample.
  static constexpr double step_doubt = 0.001;
  /// Its increase with each lost sample; half a per cent per second is 5e-7.
  static constexpr double step_drift = 4e-7;
  /// More turns than this, a day and longer, are not a measurement.
  static constexpr double most_turns = 1e6;

  [[nodiscard]] constexpr bool turning() const noexcept { return step_ > slowest_64ths; }

  /// The turn from the last sample to the first one of `packet`, from -1/8 to 7/8 of a turn: real
  /// motors move back a little at times.
  [[nodiscard]] constexpr double way_to(const decoded& packet) const noexcept {
    double way = static_cast<double>(packet.first_angle_64ths) - at_;
    while (way < -turn / 8) way += turn;
    while (way >= turn - turn / 8) way -= turn;
    return way;
  }

  /// `way`: see way_to(). `own`: see own_step().
  [[nodiscard]] constexpr sample_gap gap_before(double way, double own, bool hinted,
                                                double late_samples) const noexcept {
    if (!turning()) return {0, 0.0, !hinted};
    // A motor that spins up makes longer steps than the learnt ones; without a hint this is not a
    // loss.
    const double step =
        hinted ? step_ : std::max({step_, own_step_, own > 0.0 ? own : own_step_ + growth_});
    const double missed = way / step - 1.0;
    // Without a hint, the usual deviation of the steps between packets is not a loss, and neither is
    // the rounding of both angles to 1/64 degree.
    const double of_turn = turn / step;
    const double least = 0.5 + (hinted ? 0.0 : std::max(4.0 * roughness_, 1.0 / step));
    if (missed < least && late_samples < of_turn / 2) return {};
    // The delay may be a little less than the truth, or as long as bytes are held back.
    const double late_turns = (late_samples - missed) / of_turn + 0.3;
    const double turns = std::min(std::max(0.0, late_turns), most_turns);  // not a number: 0
    const double whole_turns = of_turn * static_cast<double>(static_cast<std::int64_t>(turns));
    const double all = std::max(missed + whole_turns, 0.0);
    const double doubt = roughness_ + (step_doubt + step_drift * all) * all;
    return {static_cast<std::int64_t>(all + 0.5), doubt < 0.5 ? 0.0 : doubt, true};
  }

  constexpr void learn(const decoded& packet, double way) noexcept {
    samples_ += packet.sample_count;
    way_ += way + static_cast<double>(packet.span_64ths);
    if (turning()) {
      const double off = way / step_ - 1.0;
      roughness_ += ((off < 0.0 ? -off : off) - roughness_) * 0.05;
    }
    if (samples_ < 24.0) return;  // too few for a division
    step_ += (way_ / samples_ - step_) * (step_ == 0.0 ? 1.0 : 0.25);
    way_ = 0.0;
    samples_ = 0.0;
  }

  /// The turn per sample within a packet; 0 if it is not known.
  [[nodiscard]] static constexpr double own_step(const decoded& packet) noexcept {
    if (packet.suspect || packet.sample_count < 8) return 0.0;  // the angles are rounded
    return static_cast<double>(packet.span_64ths) / (packet.sample_count - 1);
  }

  constexpr void follow(const decoded& packet, double own) noexcept {
    if (own > 0.0) {
      growth_ = own > 1.25 * own_step_ ? own - own_step_ : 0.0;  // less is no loss of a sample
      own_step_ = own;
    }
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
  double step_ = 0.0;       // per sample, 1/64 degree
  double own_step_ = 0.0;   // of the last packet with enough samples
  double growth_ = 0.0;     // by which it was longer than the one before
  double way_ = 0.0;        // the turn since the last update of `step_`
  double samples_ = 0.0;    // the samples of that turn
  double roughness_ = 0.1;  // the deviation of steps between packets, in samples
  bool following_ = false;  // `at_` is known
};

/// The run of packets that are too late for the count of samples. *Single thread, never allocates.*
/// After a suspension of the program the packets become less and less late, unless it is suspended
/// again. If they stay late, samples were lost without being counted.
class late_packets {
 public:
  /// A packet that is later than this was delayed by more than batching.
  static constexpr double late_ns = 25e6;

  /// Bytes were skipped: a loss nearly always damages a packet.
  constexpr void skipped() noexcept { is_torn_ = true; }
  /// Forgets what was seen, at the beginning of a stream.
  constexpr void reset() noexcept { is_late_ = is_torn_ = false; }

  /// Whether the last packet was too late.
  [[nodiscard]] constexpr bool is_late() const noexcept { return is_late_; }

  /// The next packet, measured at `time_ns`, is later than expected by `delay_ns`; `is_late`: by too
  /// much. Returns whether packets have been too late for too long.
  [[nodiscard]] constexpr bool add(bool is_late, double delay_ns, std::int64_t time_ns) noexcept {
    const bool was_late = is_late_;
    is_late_ = is_late;
    if (!is_late_) {
      is_torn_ = false;
      return false;
    }
    if (!was_late || delay_ns < least_ns_ - catching_up_ns) {
      least_ns_ = delay_ns;
      since_ns_ = steady_since_ns_ = time_ns;
    }
    if (delay_ns > least_ns_ + late_ns) steady_since_ns_ = time_ns;
    const auto late_for_ns = static_cast<double>(detail::saturating_sub(time_ns, since_ns_));
    const auto steady_for_ns =
        static_cast<double>(detail::saturating_sub(time_ns, steady_since_ns_));
    return (is_torn_ && steady_for_ns > all_late_ns) || late_for_ns > surely_late_ns;
  }

 private:
  /// The time without a packet in time, and without a decrease of the delay by this much, after which
  /// samples were lost without being counted.
  static constexpr double all_late_ns = 40e6;
  static constexpr double catching_up_ns = 5e6;
  /// The same if no byte was skipped.
  static constexpr double surely_late_ns = 1e9;

  bool is_late_ = false;
  bool is_torn_ = false;              // bytes were skipped since the last packet in time
  double least_ns_ = 0.0;             // the least delay of the run
  std::int64_t since_ns_ = 0;         // late since then, without a decrease
  std::int64_t steady_since_ns_ = 0;  // without a further delay since then
};

}  // namespace g4lidar
