// SPDX-License-Identifier: MIT
#include "stream_tally.hpp"

#include <algorithm>
#include <functional>

namespace g4lidar {
namespace {

/// Shorter stretches give no sample rate.
constexpr double shortest_pace_ns = 100e6;
/// Between two estimates of the period.
constexpr unsigned blocks_of_fit = 32;
/// The usual delay of bytes.
constexpr double usual_delay_ns = 8e6;
/// The greatest difference of the sample period from the nominal one, as a fraction of it: of a G4, from
/// 1/9000 s to 1/4000 s, it is 1.25.
constexpr arrival_window::slopes any_rate{-0.5, 2.0};

}  // namespace

void damage_counts::add(const damage_counts& other) noexcept {
  changed += other.changed;
  changed_packets += other.changed_packets;
  one_packet += other.one_packet;
  wrong_bits += other.wrong_bits;
  shortened += other.shortened;
  cut += other.cut;
  lengthened += other.lengthened;
  vanished += other.vanished;
  unclear += other.unclear;
}

void stream_tally::add(const stream_tally& other) noexcept {
  counts.add(other.counts);
  damage.add(other.damage);
  arrivals.add(other.arrivals);
  pace.add(other.pace);
  returns.add(other.returns);
  samples += other.samples;
  lost += other.lost;
  jerks += other.jerks;
  turned.add(other.turned);
  reported.add(other.reported);
  checks += other.checks;
  unsteady += other.unsteady;
}

void arrival_statistics::add(const arrival_statistics& other) noexcept {
  bytes_ += other.bytes_;
  std::transform(portions_.begin(), portions_.end(), other.portions_.begin(), portions_.begin(),
                 std::plus<>());
  portioned_ += other.portioned_;
  stalls_ += other.stalls_;
  longest_silence_ns_ = std::max(longest_silence_ns_, other.longest_silence_ns_);
  longest_pause_ns_ = std::max(longest_pause_ns_, other.longest_pause_ns_);
}

void arrival_statistics::take(const timed_read& observed) {
  bytes_ += observed.count;
  if (!observed.is_backlog && observed.silence_ns < stall_ns) {
    portions_[std::min(observed.count, portions_.size() - 1)] += observed.count;
    portioned_ += observed.count;
  }
  if (observed.silence_ns >= stall_ns) ++stalls_;
  longest_silence_ns_ = std::max(longest_silence_ns_, observed.silence_ns);
  longest_pause_ns_ = std::max(longest_pause_ns_, observed.host_pause_ns);
}

double arrival_statistics::held_back_ms(std::uint32_t baud) const noexcept {
  if (baud == 0) return 0.0;
  std::uint64_t seen = 0;
  std::size_t size = 0;
  while (size + 1 < portions_.size() && 2 * (seen += portions_[size]) < portioned_) ++size;
  return static_cast<double>(size) * 10'000.0 / static_cast<double>(baud);
}

void sample_pace::add(std::size_t samples, std::int64_t arrival_ns) noexcept {
  samples_ += static_cast<std::int64_t>(samples);
  // It only decides which arrivals are early.
  if (window_.add({samples_, arrival_ns}, period_ns_) && ++blocks_ % blocks_of_fit == 0) {
    period_ns_ = window_.fit(any_rate, usual_delay_ns).period_ns;
  }
}

void sample_pace::part() noexcept {
  if (window_.span_ns() > shortest_pace_ns) {
    const double samples = window_.span_ns() / nominal_ns_;
    parted_samples_ += samples;
    parted_ns_ += samples * window_.fit(any_rate, usual_delay_ns).period_ns;
  }
  window_.clear();
}

void sample_pace::add(const sample_pace& parted) noexcept {
  parted_samples_ += parted.parted_samples_;
  parted_ns_ += parted.parted_ns_;
}

double sample_pace::rate_hz() const noexcept {
  sample_pace all = *this;
  all.part();
  return all.parted_ns_ > 0.0 ? all.parted_samples_ * 1e9 / all.parted_ns_ : 0.0;
}

}  // namespace g4lidar
