// SPDX-License-Identifier: MIT
#include "lidar_rates.hpp"

#include <cstddef>

namespace g4_tool {
namespace {

constexpr std::chrono::seconds rate_window{3};

}  // namespace

void scan_rates::add(const g4lidar::scan& scan, clock::time_point now) {
  const std::lock_guard lock(mutex_);
  times_.push_back(now);
  while (now - times_.front() > rate_window) times_.pop_front();
  sample_rate_hz_ = static_cast<double>(scan.measured_sample_rate_hz());
  frequency_hz_ = static_cast<double>(scan.measured_frequency_hz());
}

void scan_rates::put(page_status& into, clock::time_point now) const {
  const std::lock_guard lock(mutex_);
  if (times_.size() < 2 || now - times_.back() > rate_window) return;
  const std::chrono::duration<double> took = times_.back() - times_.front();
  if (took.count() > 0) into.scan_rate_hz = static_cast<double>(times_.size() - 1) / took.count();
  into.sample_rate_hz = sample_rate_hz_;
  into.frequency_hz = frequency_hz_;
}

double loss_window::add(const lidar_counts& counts) {
  constexpr std::size_t ticks = 20;
  const sums now{counts.stream.points, counts.samples_lost};
  // The counts restart at 0 when the lidar is opened again.
  if (!sums_.empty() && now.points < sums_.back().points) sums_.clear();
  sums_.push_back(now);
  if (sums_.size() > ticks + 1) sums_.pop_front();
  const auto points = static_cast<double>(now.points - sums_.front().points);
  const auto lost = static_cast<double>(now.lost - sums_.front().lost);
  return lost > 0 ? lost / (points + lost) : 0.0;
}

}  // namespace g4_tool
