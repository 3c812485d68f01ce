// SPDX-License-Identifier: MIT
// The times of the samples of a packet, which increase from packet to packet.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/point.hpp"

namespace g4lidar {

/// The measurement times of the samples of one packet.
struct packet_times {
  std::int64_t first_ns = 0;  ///< Of the first sample.
  double step_ns = 0.0;       ///< From each sample to the next.
  std::int64_t bound_ns = 0;  ///< The greatest possible difference of these times from the truth.
  std::int64_t lost = 0;      ///< Samples that were lost before this packet.

  /// The time of sample `i`.
  [[nodiscard]] constexpr std::int64_t at(std::size_t i) const noexcept {
    return after(static_cast<std::uint64_t>(i) * step_fixed());
  }
  /// Writes the times to all points of the packet.
  constexpr void write_to(std::span<point> points) const noexcept {
    const std::uint64_t step = step_fixed();
    std::uint64_t way = 0;
#pragma GCC unroll 8
    for (point& p : points) {
      p.time_ns = after(way);
      way += step;
    }
  }

 private:
  /// A step of a second, 80 times, fits with so many bits behind the point.
  static constexpr int fraction_bits = 20;
  [[nodiscard]] constexpr std::uint64_t step_fixed() const noexcept {
    return static_cast<std::uint64_t>(
        detail::saturated<std::int64_t>(step_ns * (1 << fraction_bits)));
  }
  [[nodiscard]] constexpr std::int64_t after(std::uint64_t way) const noexcept {
    return detail::wrapping_add(first_ns, static_cast<std::int64_t>(way) >> fraction_bits);
  }
};

namespace detail {

/// Times that increase from sample to sample and from packet to packet. *Single thread, never allocates.*
class increasing_times {
 public:
  /// The times of `count` samples, 1 to 65536, of which the last one is at `last_ns`. If that is not after the previous
  /// samples, the steps are shortened until it is; the bound is the delay that results. `period_ns`: above 0, up to 4e9.
  [[nodiscard]] constexpr packet_times until(std::int64_t last_ns, std::int64_t count,
                                             double period_ns) noexcept {
    const double steps = static_cast<double>(count - 1);
    const double shortest_ns = period_ns / 4.0;
    const std::int64_t first_ns =
        wrapping_sub(last_ns, static_cast<std::int64_t>(steps * period_ns));
    packet_times times;
    times.first_ns = first_ns;
    times.step_ns = period_ns;
    if (any_) {
      times.first_ns =
          std::max(first_ns, wrapping_add(last_ns_, static_cast<std::int64_t>(shortest_ns)));
    }
    if (times.first_ns > first_ns && count > 1) {
      const double fitting = static_cast<double>(wrapping_sub(last_ns, times.first_ns)) / steps;
      times.step_ns = std::max(shortest_ns, fitting);
    }
    any_ = true;
    last_ns_ = times.at(static_cast<std::size_t>(count - 1));
    times.bound_ns = wrapping_sub(times.first_ns, first_ns);
    return times;
  }

 private:
  bool any_ = false;
  std::int64_t last_ns_ = 0;  // the time of the last sample
};

}  // namespace detail

}  // namespace g4lidar
