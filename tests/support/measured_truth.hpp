// SPDX-License-Identifier: MIT
// What a simulated device truly measured, and which points of a damaged stream are of it.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "g4lidar/sim/device.hpp"

namespace g4lidar::test {

/// How many samples of a revolution there were, and how many of them came through undamaged.
struct revolution_truth {
  std::size_t sent = 0;
  std::size_t intact = 0;
};

/// The manual's formula, written anew; without a return that of a far target.
inline double direction_of(const sim::sample_truth& truth) {
  const double range_mm = truth.raw == 0 ? 1e15 : truth.raw / 4.0;
  const double turn_rad = std::atan(21.8 * (155.3 - range_mm) / (155.3 * range_mm));
  return truth.first_level_deg + turn_rad * 180.0 / std::numbers::pi;
}

/// Whether a point looks like this sample, but for what the angles of packets are rounded to.
inline bool looks_like(const sim::sample_truth& truth, double angle_deg, double range_mm) {
  const double off = direction_of(truth) - angle_deg;
  return truth.raw / 4.0 == range_mm && std::abs(std::remainder(off, 360.0)) <= 1.0 / 64 + 0.001;
}

class measured_truth {
 public:
  measured_truth() = default;
  explicit measured_truth(std::vector<sim::sent_sample> samples) : samples_(std::move(samples)) {
    for (const sim::sent_sample& each : samples_) {
      revolution_truth& into = revolutions_[each.truth.revolution];
      ++into.sent;
      into.intact += each.whole;
    }
  }

  /// All that the device has sent since it was asked last.
  static measured_truth of(sim::device& simulated, std::size_t capacity) {
    std::vector<sim::sent_sample> samples(capacity);
    samples.resize(simulated.take_truth(samples));
    return measured_truth(std::move(samples));
  }

  /// The next intact sample, of at most `most`, for which the test is true; the search goes on behind it.
  /// Null where there is none.
  template <class IsIt>
  const sim::sample_truth* next(std::size_t most, const IsIt& is_it) {
    for (std::size_t i = next_; i < samples_.size() && i < next_ + most; ++i) {
      if (!samples_[i].whole || !is_it(samples_[i].truth)) continue;
      next_ = i + 1;
      return &samples_[i].truth;
    }
    return nullptr;
  }

  [[nodiscard]] const std::vector<sim::sent_sample>& samples() const { return samples_; }
  [[nodiscard]] const std::map<std::uint64_t, revolution_truth>& revolutions() const {
    return revolutions_;
  }
  /// Intact samples of all revolutions but the first and the last, of which only pieces were sent.
  [[nodiscard]] std::size_t intact() const {
    std::size_t count = 0;
    for (const auto& [revolution, truth] : revolutions_) {
      const bool is_piece =
          revolution == revolutions_.begin()->first || revolution == revolutions_.rbegin()->first;
      if (!is_piece) count += truth.intact;
    }
    return count;
  }

 private:
  std::vector<sim::sent_sample> samples_;
  std::map<std::uint64_t, revolution_truth> revolutions_;
  std::size_t next_ = 0;
};

}  // namespace g4lidar::test
