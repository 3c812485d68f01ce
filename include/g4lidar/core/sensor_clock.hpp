// SPDX-License-Identifier: MIT
// Estimates when each sample was measured, from sample counts and arrival times.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "g4lidar/core/clock/arrival_window.hpp"
#include "g4lidar/core/clock/packet_times.hpp"
#include "g4lidar/core/clock/sample_counter.hpp"
#include "g4lidar/core/decode.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/detail/saturating.hpp"

namespace g4lidar {

/// What a sensor_clock cannot determine by itself. A number out of range counts as the nearest one.
struct sensor_clock_options {
  double sample_rate_hz = g4_model.rates.nominal_hz;  ///< Nominal, 1 to 10^9.
  /// How far the true time between two samples may be from the nominal one, as a fraction of it, below
  /// 0.5. See expected_rate_of().
  double rate_tolerance = 0.04;
  /// The least delay of every byte after the serial connection, within 30 years of 0.
  std::int64_t transport_delay_ns = 0;
  /// Bits per second, 10 bits per byte; 0: bytes take no time.
  std::uint32_t baud = g4_model.bauds[0];
  sample_layout layout = g4_layout;  ///< Of the packets.
};

/// Estimates when samples were measured. *Single thread, never allocates, never waits*: bounded
/// work per packet.
///
/// Samples are equidistant, and arrivals are late, never early: the times of the samples are the
/// line below the arrivals. A delay that all arrivals have in common cannot be derived from them;
/// it is an option. `docs/design/sensor_clock.md` has the accuracy and the reasons.
class sensor_clock {
 public:
  /// At the beginning of a stream.
  explicit constexpr sensor_clock(const sensor_clock_options& options = {}) noexcept
      : options_(options),
        sample_size_(sample_size(options.layout)),
        nominal_ns_(period_ns_of(options.sample_rate_hz)),
        window_(nominal_ns_) {
    options_.rate_tolerance = possible_tolerance(options.rate_tolerance);
    options_.transport_delay_ns = possible_ns(options.transport_delay_ns, most_ns / 2);
    line_.period_ns = nominal_ns_;
    restart();
  }

  /// The times of the samples of `packet`, whose last byte arrived at `arrival_ns` of a monotonic
  /// clock, within 70 years of 0; another time counts as the nearest one. Call it once for every
  /// packet, in order, also for suspect ones.
  /// Times are strictly increasing, from sample to sample and from packet to packet, in all cases.
  constexpr packet_times stamp(const decoded& packet, std::int64_t arrived_ns) noexcept {
    const std::int64_t arrival_ns = possible_ns(arrived_ns);
    const std::int64_t count = std::max<std::int64_t>(packet.sample_count, 1);
    const sample_gap gap = counter_.next(packet, hinted_, late_samples(count, arrival_ns));
    if (gap.lost > 0) part_.forget();  // bytes of a packet that never arrived
    const std::int64_t before = measured_before(count, arrival_ns);
    hinted_ = false;
    skipped_bytes_ = 0.0;
    next_ += gap.lost + count;
    doubt(gap);
    const observed seen = observe({next_ - 1, before});
    packet_times times = times_until(std::min(seen.at_ns, before), count);
    if (late_.is_late()) {  // samples may be missing
      times.bound_ns =
          detail::saturating_add(times.bound_ns, detail::saturating_sub(before, seen.at_ns));
    }
    bound_ns_ = times.bound_ns;
    times.lost = detail::wrapping_add(gap.lost, seen.missed);
    return times;
  }

  /// Optional; makes the times several times more accurate if bytes arrive in bursts: `count` bytes
  /// of an incomplete packet, with its header, have arrived by `arrival_ns`. After each read into a
  /// stream_parser: `if (parser.held() >= packet_header_size) clock.seen(parser.held(), now)`. A
  /// device sends no byte of a packet before its last sample is measured, so this gives as much
  /// information as the arrival of a whole packet.
  constexpr void seen(std::size_t count, std::int64_t arrival_ns) noexcept {
    if (count < packet_header_size || count > max_packet_size) return;
    part_.add(count, possible_ns(arrival_ns) - line_time_ns(count));
  }

  /// Packets were probably lost here: call it after each skip with a reason other than noise, of
  /// `count` bytes. Gaps are counted without it too; with it, short gaps are counted more exactly,
  /// and gaps longer than a turn immediately.
  constexpr void lost(std::size_t count) noexcept {
    hinted_ = true;
    late_.skipped();
    skipped_bytes_ += static_cast<double>(count);
    part_.forget();
  }

  /// The stream starts again: nothing is known except, approximately, the sample rate. Times still
  /// increase.
  constexpr void reset() noexcept {
    counter_.reset();
    hinted_ = false;
    skipped_bytes_ = 0.0;
    part_.forget();
    restart();
  }
  /// The same with another nominal sample rate and its tolerance; see sensor_clock_options.
  constexpr void reset(expected_rate rate) noexcept {
    options_.rate_tolerance = possible_tolerance(rate.tolerance);
    nominal_ns_ = period_ns_of(rate.hz);
    line_.period_ns = nominal_ns_;
    window_ = arrival_window(nominal_ns_);
    rate_known_ = false;
    reset();
  }

  /// The last estimate of the sample rate.
  [[nodiscard]] constexpr double sample_rate_hz() const noexcept { return 1e9 / line_.period_ns; }
  /// When the sample after the last one of the last packet is measured; 0 before the first packet.
  [[nodiscard]] constexpr std::int64_t next_sample_ns() const noexcept {
    return started_ ? line_.at(next_) : 0;
  }
  /// The bound of the last packet, in nanoseconds; 0 before the first.
  [[nodiscard]] constexpr std::int64_t bound_ns() const noexcept { return bound_ns_; }

 private:
  /// Within 70 years of 0: two such times have a sum and a difference.
  static constexpr std::int64_t most_ns = std::int64_t{1} << 61;
  [[nodiscard]] static constexpr std::int64_t possible_ns(std::int64_t time_ns,
                                                          std::int64_t most = most_ns) noexcept {
    return std::clamp(time_ns, -most, most);
  }
  [[nodiscard]] static constexpr double possible_tolerance(double tolerance) noexcept {
    return tolerance >= 0.0 ? std::min(tolerance, 0.499) : 0.0;
  }
  /// The period of a rate.
  [[nodiscard]] static constexpr double period_ns_of(double hz) noexcept {
    return 1e9 / (hz >= 1.0 ? std::min(hz, 1e9) : 1.0);
  }

  /// The received part of the next packet, and the limit that it gives for the times.
  class received_part {
   public:
    /// `count` bytes; their last sample was measured before `before_ns`.
    constexpr void add(std::size_t count, std::int64_t before_ns) noexcept {
      before_ns_ = count_ == 0 ? before_ns : std::min(before_ns, before_ns_);
      count_ = std::max(count_, count);
    }
    constexpr void forget() noexcept { count_ = 0; }
    /// The limit of the packet of `size` bytes, which gives `before_ns` itself.
    [[nodiscard]] constexpr std::int64_t take_limit(std::size_t size,
                                                    std::int64_t before_ns) noexcept {
      const bool is_part = count_ > 0 && count_ < size;
      forget();
      return is_part ? std::min(before_ns, before_ns_) : before_ns;
    }

   private:
    std::size_t count_ = 0;
    std::int64_t before_ns_ = 0;
  };

  /// A stream whose packets are usually later than that is not live.
  static constexpr double most_delay_ns = 10e6;
  /// A window longer than this determines the rate by itself.
  static constexpr double enough_ns = 4e9;
  /// An arrival earlier than this, and earlier than the bound allows, disproves the count.
  static constexpr double early_ns = 1e6;
  /// If the count of lost samples is uncertain by more than this, no times can be derived.
  static constexpr double most_doubt_ns = 1e6;
  /// The limit of the difference of the period from the nominal one, with a margin.
  [[nodiscard]] constexpr double widest() const noexcept { return 1.25 * options_.rate_tolerance; }
  /// The limit of the error of a rate that was learnt.
  static constexpr double known_rate = 300e-6;
  /// The assumed delay of packets until it is known, and its minimum.
  static constexpr double unknown_late_ns = 8e6;
  static constexpr double least_late_ns = 1e3;

  [[nodiscard]] constexpr std::int64_t line_time_ns(std::size_t count) const noexcept {
    const auto bits = static_cast<std::int64_t>(count) * 10;
    return options_.baud == 0 ? 0 : bits * 1'000'000'000 / options_.baud;
  }

  /// By how many samples a packet of `count` samples is later than it would be without loss; 0 if
  /// fewer bytes were skipped than that, because then the program may have been suspended.
  [[nodiscard]] constexpr double late_samples(std::int64_t count,
                                              std::int64_t arrival_ns) const noexcept {
    if (!started_ || skipped_bytes_ <= 0.0) return 0.0;
    const std::int64_t expected =
        detail::saturating_add(line_.at(next_ + count - 1), options_.transport_delay_ns);
    const double late =
        static_cast<double>(detail::saturating_sub(arrival_ns, expected)) / line_.period_ns;
    return late < skipped_bytes_ ? late : 0.0;  // at least two bytes per sample
  }

  /// A time before which the last of the `count` samples of a packet was measured.
  [[nodiscard]] constexpr std::int64_t measured_before(std::int64_t count,
                                                       std::int64_t arrival_ns) noexcept {
    arrival_ns_ = std::max(arrival_ns_, arrival_ns);
    const std::size_t size = packet_header_size + static_cast<std::size_t>(count) * sample_size_;
    return part_.take_limit(size, arrival_ns_ - line_time_ns(size)) - options_.transport_delay_ns;
  }

  /// Clears the window. The rate is kept: a device that starts again has the same oscillator.
  constexpr void restart() noexcept {
    const double slope = line_.period_ns / nominal_ns_ - 1.0;
    const double doubt = rate_known_ ? known_rate : 2.0 * widest();
    slopes_ = {std::max(-widest(), slope - doubt), std::min(widest(), slope + doubt)};
    window_.clear();
    started_ = false;
    late_.reset();
  }

  /// A gap whose count is uncertain widens the bound; a gap of unknown size separates the times
  /// before it from those after it.
  constexpr void doubt(const sample_gap& gap) noexcept {
    const double doubt_ns = gap.doubt_samples * line_.period_ns;
    if (!gap.known || doubt_ns > most_doubt_ns) return restart();
    doubt_ns_ = std::max(doubt_ns_, doubt_ns);
  }

  struct observed {
    std::int64_t missed;  // samples that must have been lost without being detected
    std::int64_t at_ns;   // of the sample, by the line
  };
  /// Updates the line.
  constexpr observed observe(arrival next) noexcept {
    const std::int64_t at_ns = line_.at(next.sample);
    double late = started_ ? static_cast<double>(detail::saturating_sub(next.time_ns, at_ns)) : 0.0;
    std::int64_t missed = 0;
    const bool is_too_early = late < -early_ns && late < -3.0 * line_.bound_ns;
    if (is_too_early || stays_late(late, next)) {
      if (late > 0.0) missed = unseen_samples(late);
      if (window_.span_ns() <= enough_ns) rate_known_ = false;  // it may be the error
      mean_late_ns_ = unknown_late_ns;
      restart();
      late = 0.0;
    }
    if (late_.is_late()) return {0, at_ns};
    if (late < 0.0 && -late > line_.bound_ns / 3.0) doubt_ns_ = std::max(doubt_ns_, -2.0 * late);
    started_ = true;
    in_time_ = next.sample;
    mean_late_ns_ += (std::max(late, least_late_ns) - mean_late_ns_) * 0.02;
    if (!window_.add(next, line_.period_ns)) return {missed, at_ns};
    if (window_.span_ns() > enough_ns) {
      rate_known_ = true;
      slopes_ = {-widest(), widest()};
    }
    line_ = window_.fit(slopes_, mean_late_ns_);
    // Impossible arrivals can have no line.
    if (!(line_.period_ns > 0.0 && line_.period_ns < 4.0 * nominal_ns_))
      line_.period_ns = nominal_ns_;
    return {missed, line_.at(next.sample)};
  }

  /// How many samples were lost if packets stay late by so much: whole turns, since the angles show
  /// the rest. The remainder is delay of the host.
  [[nodiscard]] constexpr std::int64_t unseen_samples(double late) const noexcept {
    const double samples = late / line_.period_ns;
    const double step = counter_.step_64ths();
    if (step <= 0.0) return detail::saturated<std::int64_t>(samples);
    const double of_turn = turn_64ths / step;
    const auto turns = detail::saturated<std::int64_t>(samples / of_turn + 0.5);
    return detail::saturated<std::int64_t>(static_cast<double>(turns) * of_turn + 0.5);
  }

  /// Whether packets have been too late for too long: then samples were lost without being counted.
  [[nodiscard]] constexpr bool stays_late(double late, arrival next) noexcept {
    const double usual_ns =
        std::max(late_packets::late_ns, 8.0 * std::min(line_.mean_delay_ns, most_delay_ns));
    return late_.add(late > usual_ns && late > usual_ns + drift_since_ns(next), late, next.time_ns);
  }

  /// The largest delay of packets since the last one in time, if the rate differs from the assumed
  /// one.
  [[nodiscard]] constexpr double drift_since_ns(arrival next) const noexcept {
    const double slope = line_.period_ns / nominal_ns_ - 1.0;
    const bool known = rate_known_ || window_.span_ns() > enough_ns;
    const double doubt = known ? known_rate : std::max(slopes_.highest - slope, known_rate);
    return doubt * static_cast<double>(next.sample - in_time_) * nominal_ns_;
  }

  [[nodiscard]] constexpr packet_times times_until(std::int64_t last_ns,
                                                   std::int64_t count) noexcept {
    packet_times times = times_.until(last_ns, count, line_.period_ns);
    const auto behind_ns = static_cast<double>(times.bound_ns);
    times.bound_ns = detail::saturating_add(
        detail::saturated<std::int64_t>(line_.bound_ns + behind_ns + doubt_ns_), 1000);
    doubt_ns_ *= 0.999;  // later arrivals reduce the doubt
    return times;
  }

  sensor_clock_options options_;
  std::size_t sample_size_;
  double nominal_ns_;
  sample_counter counter_;
  arrival_window window_;
  sampling_line line_;
  arrival_window::slopes slopes_{};
  std::int64_t next_ = 0;  // number of the next sample
  std::int64_t arrival_ns_ = std::numeric_limits<std::int64_t>::min();
  received_part part_;
  late_packets late_;
  detail::increasing_times times_;
  std::int64_t in_time_ = 0;  // the last sample of a packet that was in time
  std::int64_t bound_ns_ = 0;
  double mean_late_ns_ = unknown_late_ns;
  double skipped_bytes_ = 0.0;  // since the last packet
  double doubt_ns_ = 0.0;       // by uncertain counts of lost samples
  bool started_ = false;        // the line exists
  bool rate_known_ = false;
  bool hinted_ = false;
};

}  // namespace g4lidar
