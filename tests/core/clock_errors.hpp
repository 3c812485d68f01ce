// SPDX-License-Identifier: MIT
// The errors of a sensor_clock, compared with the truth of tests/support/arrival_model.hpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "g4lidar/core/sensor_clock.hpp"
#include "support/arrival_model.hpp"

namespace g4lidar::arrivals {

/// What the caller passes to the clock in addition to packets.
struct hints {
  bool seen = true;
  bool lost = true;
};

/// The errors of points from `after_s` on, over any number of runs.
struct errors {
  double after_s = 5.0;
  double points = 0.0;
  double square_sum = 0.0;
  double worst_ns = 0.0;
  double broken = 0.0;
  bool grows = true;
  int wrong_counts = 0;
  std::vector<double> bounds;  // of packets
  std::int64_t last_ns = std::numeric_limits<std::int64_t>::min();

  void add(const delivery& d, const packet_times& times, std::int64_t start_ns) {
    if (times.lost != d.lost_samples) ++wrong_counts;
    for (std::size_t i = 0; i < d.packet.sample_count; ++i) {
      grows = grows && times.at(i) > last_ns;
      last_ns = times.at(i);
      if (d.measured_ns[i] < after_s * 1e9) continue;
      const double error = static_cast<double>(times.at(i) - start_ns) - d.measured_ns[i];
      points += 1.0;
      square_sum += error * error;
      worst_ns = std::max(worst_ns, std::abs(error));
      if (std::abs(error) > static_cast<double>(times.bound_ns)) broken += 1.0;
      if (i == 0) bounds.push_back(static_cast<double>(times.bound_ns));
    }
  }
  void add(const errors& other) {
    points += other.points;
    square_sum += other.square_sum;
    worst_ns = std::max(worst_ns, other.worst_ns);
    broken += other.broken;
    grows = grows && other.grows;
    wrong_counts += other.wrong_counts;
    bounds.insert(bounds.end(), other.bounds.begin(), other.bounds.end());
  }
  [[nodiscard]] double rms_us() const { return std::sqrt(square_sum / points) / 1e3; }
  [[nodiscard]] double worst_us() const { return worst_ns / 1e3; }
  [[nodiscard]] double broken_share() const { return broken / points; }
  [[nodiscard]] double median_bound_us() {
    const auto middle = bounds.begin() + static_cast<std::ptrdiff_t>(bounds.size() / 2);
    std::nth_element(bounds.begin(), middle, bounds.end());
    return *middle / 1e3;
  }
  void print(const std::string& name) {
    std::printf("  %-34s rms %6.1f us, worst %7.1f us, bound %6.1f us, broken %.5f\n", name.c_str(),
                rms_us(), worst_us(), median_bound_us(), broken_share());
  }
};

inline packet_times stamp(sensor_clock& clock, const delivery& d, const hints& given) {
  if (given.lost && d.lost_bytes > 0) clock.lost(d.lost_bytes);
  if (given.seen && d.seen_bytes > 0) clock.seen(d.seen_bytes, d.seen_ns);
  return clock.stamp(d.packet, d.arrival_ns);
}

/// A device with random rate and motor for `seed`.
inline options drawn(options o, std::uint64_t seed) {
  o.seed = seed;
  model dice(options{.seed = seed + 777});
  o.rate_error = 0.06 * (dice.uniform() - 0.5);
  o.motor_hz = 5.0 + 7.0 * dice.uniform();
  return o;
}

inline errors simulate(const options& o, const hints& given, double seconds) {
  model device(o);
  sensor_clock clock({.sample_rate_hz = o.nominal_hz, .baud = static_cast<std::uint32_t>(o.baud)});
  errors found;
  while (device.now_s() < seconds) {
    const delivery d = device.next();
    found.add(d, stamp(clock, d, given), o.start_ns);
  }
  return found;
}

}  // namespace g4lidar::arrivals
