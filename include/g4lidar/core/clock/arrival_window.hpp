// SPDX-License-Identifier: MIT
// The earliest arrivals of the last seconds, and the line of sampling times below them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "g4lidar/core/clock/arrival_line.hpp"
#include "g4lidar/detail/saturating.hpp"

namespace g4lidar {

/// A sample, counted from the start, and a time before which it was measured: both within 2^62 of 0.
struct arrival {
  std::int64_t sample = 0;
  std::int64_t time_ns = 0;
};

/// Sampling times as a line through an anchor.
struct sampling_line {
  arrival anchor;
  double period_ns = 0.0;
  double bound_ns = 0.0;       ///< The greatest possible error, near the newest arrivals.
  double mean_delay_ns = 0.0;  ///< Of the earliest arrivals of each block of samples.

  /// The time of `sample`.
  [[nodiscard]] constexpr std::int64_t at(std::int64_t sample) const noexcept {
    const std::int64_t samples = detail::wrapping_sub(sample, anchor.sample);
    return detail::wrapping_add(
        anchor.time_ns, detail::saturated<std::int64_t>(static_cast<double>(samples) * period_ns));
  }
};

/// Keeps the earliest arrival of each of up to 64 blocks of samples, and estimates lines below
/// them. *Single thread, never allocates.* A block is 20 ms at first; when all blocks are in use,
/// pairs are merged, until a block is 320 ms long; then the oldest is dropped: the window grows to
/// 20 s and then slides.
class arrival_window {
 public:
  /// The known limits of the sample rate, as the relative error of the nominal period.
  struct slopes {
    double lowest;
    double highest;
  };

  /// An empty one. `nominal_ns` is the period of the samples, within a half.
  explicit constexpr arrival_window(double nominal_ns) noexcept : nominal_ns_(nominal_ns) {}

  /// Forgets all arrivals.
  constexpr void clear() noexcept {
    size_ = 0;
    block_ = detail::saturated<std::int64_t>(first_block_ns / nominal_ns_);
  }

  /// Adds an arrival; samples never decrease. Returns whether it began a block. `period_ns` decides
  /// which of two arrivals is earlier.
  constexpr bool add(arrival next, double period_ns) noexcept {
    if (size_ > 0 && next.sample < detail::wrapping_add(block_start_, block_)) {
      if (is_below(next, blocks_[size_ - 1], period_ns)) blocks_[size_ - 1] = next;
      return false;
    }
    if (size_ == most) make_room(period_ns);
    block_start_ = next.sample;
    blocks_[size_++] = next;
    return true;
  }

  /// From the first to the last arrival, with the nominal period.
  [[nodiscard]] constexpr double span_ns() const noexcept {
    if (size_ == 0) return 0.0;
    return way(blocks_[0].sample, blocks_[size_ - 1].sample) * nominal_ns_;
  }

  /// The line; at least one arrival is required. `mean_late_ns`, above 0: the mean delay of
  /// packets. The block that is being filled is not used, unless it is the only one.
  [[nodiscard]] constexpr sampling_line fit(slopes within, double mean_late_ns) const noexcept {
    const std::size_t end = size_ < 2 ? size_ : size_ - 1;
    const arrival newest = blocks_[end - 1];
    line_under_points points;
    candidates found;
    std::size_t wanted = end;  // an eighth of the blocks, then a quarter, a half, and all
    for (int halvings = 0; halvings < 3 && wanted >= 16; ++halvings) wanted = (wanted + 1) / 2;
    for (std::size_t taken = 1; taken <= end; ++taken) {
      const arrival next = blocks_[end - taken];
      const double x = way(newest.sample, next.sample) * nominal_ns_;
      points.add_left(x, way(newest.time_ns, next.time_ns) - x);
      if (taken < std::min(wanted, end)) continue;
      candidate& c = found.all[found.count++];
      c.line = points.estimate(within.lowest, within.highest, mean_late_ns);
      c.reach_ns = std::max(-x, first_block_ns);
      wanted = 2 * taken;
    }
    return chosen(found, newest, mean_late_ns);
  }

 private:
  static constexpr std::size_t most = line_under_points::capacity;
  static constexpr double first_block_ns = 20e6;
  static constexpr double last_block_ns = 320e6;
  // Changes of the rate per second, in 1/ns. 200 ppm up and down within a minute is 21 ppm/s.
  static constexpr double mean_drift = 10e-15;
  static constexpr double usual_drift = 25e-15;
  static constexpr double largest_drift = 65e-15;
  // The part of its mean delay by which a window of 1 s can be wrong without notice, if the packets
  // beat with the timer of the bridge. Determined by experiment, like the two below.
  static constexpr double hidden_share = 0.6e18;
  static constexpr double hidden_weight = 0.4;
  static constexpr double deviations = 7.0;

  struct candidate {
    line_estimate line;
    double reach_ns = 0.0;
  };
  struct candidates {
    std::array<candidate, 5> all;  // from the shortest window to the longest
    std::size_t count = 0;
  };

  [[nodiscard]] static constexpr double way(std::int64_t from, std::int64_t to) noexcept {
    return static_cast<double>(detail::wrapping_sub(to, from));
  }
  [[nodiscard]] static constexpr bool is_below(arrival a, arrival b, double period_ns) noexcept {
    return way(b.time_ns, a.time_ns) <= way(b.sample, a.sample) * period_ns;
  }

  constexpr void make_room(double period_ns) noexcept {
    if (static_cast<double>(block_) * nominal_ns_ > 0.9 * last_block_ns) {
      std::copy(blocks_.begin() + 1, blocks_.end(), blocks_.begin());
      --size_;
      return;
    }
    for (std::size_t i = 0; i < most / 2; ++i) {
      const arrival left = blocks_[2 * i];
      const arrival right = blocks_[2 * i + 1];
      blocks_[i] = is_below(right, left, period_ns) ? right : left;
    }
    size_ = most / 2;
    block_ = detail::wrapping_add(block_, block_);
  }

  /// The error of a line at its end if the rate changes by `drift`.
  [[nodiscard]] static constexpr double sag(const candidate& c, double drift) noexcept {
    return drift * c.reach_ns * c.reach_ns / 8.0;
  }

  /// Whether a longer window shows that `found.all[i]` is later than drift can explain. A line that
  /// is too early is disproved by the next early arrival; a line that is late is not.
  [[nodiscard]] static constexpr bool is_late(const candidates& found, std::size_t i) noexcept {
    for (std::size_t j = i + 1; j < found.count; ++j) {
      const candidate& longer = found.all[j];
      const double late = found.all[i].line.offset - longer.line.offset;
      if (late > sag(longer, largest_drift) + 3.0 * longer.line.offset_deviation) return true;
    }
    return false;
  }

  /// The window with the least sum of noise and drift.
  [[nodiscard]] constexpr sampling_line chosen(const candidates& found, arrival newest,
                                               double mean_late_ns) const noexcept {
    const double longest = found.all[found.count - 1].reach_ns;
    double least = 1e300;
    sampling_line result;
    for (std::size_t i = 0; i < found.count; ++i) {
      const candidate& c = found.all[i];
      if (is_late(found, i)) continue;
      const double hidden = hidden_share * mean_late_ns / c.reach_ns;
      const double noise = c.line.offset_deviation;
      const double bend = sag(c, mean_drift);
      const double veil = hidden_weight * hidden / c.reach_ns;
      const double cost = noise * noise + bend * bend + veil * veil;
      if (cost >= least) continue;
      least = cost;
      result.anchor = {
          newest.sample,
          detail::wrapping_add(newest.time_ns, detail::saturated<std::int64_t>(c.line.offset))};
      result.period_ns = nominal_ns_ * (1.0 + c.line.slope);
      result.bound_ns = deviations * noise + sag(c, usual_drift) + std::min(hidden / longest, 10e6);
      result.mean_delay_ns = c.line.mean_delay;
    }
    return result;
  }

  double nominal_ns_;
  std::array<arrival, most> blocks_{};
  std::size_t size_ = 0;
  std::int64_t block_start_ = 0;  // of the newest block
  std::int64_t block_ = 1;        // samples per block
};

}  // namespace g4lidar
