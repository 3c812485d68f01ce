// SPDX-License-Identifier: MIT
#include "survey.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <variant>

#include "io/far_times.hpp"

namespace g4_tool::acceptance {
namespace {

/// The byte of intensity of a sample of three bytes.
int low_intensity(packet_view packet, std::size_t i) noexcept {
  return packet.intensity_word(i) & 0xFF;
}

}  // namespace

void direction_survey::take(packet_view packet) {
  std::array<point, max_samples> memory;
  bytes input = packet.data();
  for (const point& each : decoder_.decode(input, memory)) {
    if (each.range_mm <= 0.0F) continue;
    const auto degree = static_cast<std::size_t>(each.angle_deg);
    if (degree < ranges_.size()) ranges_[degree].push_back(each.range_mm);
  }
}

std::optional<double> direction_survey::range_mm(std::size_t degree) const {
  constexpr std::size_t fewest = 5;
  std::vector<float> all = ranges_.at(degree);
  if (all.size() < fewest) return std::nullopt;
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::ranges::nth_element(all, middle);
  return *middle;
}

std::optional<std::size_t> direction_survey::nearest() const {
  std::optional<std::size_t> best;
  double least_mm = std::numeric_limits<double>::infinity();
  for (std::size_t degree = 0; degree < ranges_.size(); ++degree) {
    const double here_mm = range_mm(degree).value_or(least_mm);
    if (here_mm >= least_mm) continue;
    least_mm = here_mm;
    best = degree;
  }
  if (!best) return best;
  // A flat target has nearly the same range in many directions: the middle of them.
  const double same_mm = 1.01 * least_mm + 2.0;
  const auto is_target = [&](std::size_t degree) {
    return range_mm(degree % ranges_.size()).value_or(2.0 * same_mm) <= same_mm;
  };
  constexpr std::size_t widest = 60;
  const std::size_t turn = ranges_.size() + *best;
  std::size_t first = turn;
  std::size_t last = turn;
  while (turn - first < widest && is_target(first - 1)) --first;
  while (last - turn < widest && is_target(last + 1)) ++last;
  return (first + last) / 2 % ranges_.size();
}

std::optional<std::size_t> direction_survey::farthest() const {
  std::optional<std::size_t> best;
  double most_mm = 0.0;
  for (std::size_t degree = 0; degree < ranges_.size(); ++degree) {
    const double here_mm = range_mm(degree).value_or(0.0);
    if (here_mm <= most_mm) continue;
    most_mm = here_mm;
    best = degree;
  }
  return best;
}

void packet_survey::take(const event& found, std::int64_t arrival_ns) {
  if (const auto* const packet = std::get_if<packet_view>(&found)) take(*packet, arrival_ns);
  counts.add(found);
  if (const auto* const gone = std::get_if<skipped>(&found)) {
    if (gone->reason == skip_reason::bad_checksum) ++bad_checksums;
    revolution_.add(*gone);
    reader_.add(*gone);
  }
}

void packet_survey::take(packet_view packet, std::int64_t arrival_ns) {
  directions.take(packet);
  if (const auto fits = revolution_.add(packet)) ++(*fits ? crc_fits : crc_misfits);
  static_cast<void>(reader_.add(packet));
  if (packet.is_zero()) {
    zeros_.push_back({arrival_ns, samples_});
    reported_chz_ += static_cast<std::uint64_t>(packet.reported_frequency_chz());
    ++zero_packets;
  }
  const std::size_t count = packet.sample_count();
  most_samples = std::max(most_samples, count);
  if (zero_packets > 0) samples_ += count;
  const int units = range_units_per_mm(layout_);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint16_t word = packet.sample(i);
    const int range_mm = word / units;
    const zone where = range_mm == 0     ? no_return
                       : range_mm < 1000 ? below_1_m
                       : range_mm < 2000 ? below_2_m
                                         : beyond;
    ++bits.at(where).at(word & 3U);
  }
  if (sample_size(layout_) == 3) compare_intensities(packet);
}

void packet_survey::compare_intensities(packet_view packet) {
  constexpr int near = 16;  // of an intensity that goes on
  for (std::size_t i = 1; i < packet.sample_count(); ++i) {
    const std::uint16_t last = packet.sample(i - 1);
    const std::uint16_t now = packet.sample(i);
    const int step = static_cast<int>(now & 3U) - static_cast<int>(last & 3U);
    if (last >> 2U == 0 || now >> 2U == 0 || (step != 1 && step != -1)) continue;
    const int change = low_intensity(packet, i) - low_intensity(packet, i - 1);
    const bool is_smooth = std::abs(change) <= near;
    const bool is_overflow = std::abs(change + 256 * step) <= near;
    if (is_smooth != is_overflow) ++(is_overflow ? overflows : smooth_changes);
  }
}

double packet_survey::per_second(std::uint64_t count) const noexcept {
  if (zeros_.empty()) return 0.0;
  const double seconds =
      static_cast<double>(way_ns(zeros_.front().time_ns, zeros_.back().time_ns)) / 1e9;
  return seconds > 0.0 ? static_cast<double>(count) / seconds : 0.0;
}

bool packet_survey::is_steady() const {
  constexpr std::size_t fewest = 3;
  constexpr double part = 0.02;
  if (zeros_.size() < fewest) return false;
  const arrival& first = zeros_.front();
  const auto all_ns = static_cast<double>(way_ns(first.time_ns, zeros_.back().time_ns));
  const auto samples = static_cast<double>(zeros_.back().samples);
  return std::ranges::all_of(zeros_, [&](const arrival& each) {
    const double due_ns = all_ns * static_cast<double>(each.samples) / samples;
    return std::abs(static_cast<double>(way_ns(first.time_ns, each.time_ns)) - due_ns) <
           part * all_ns;
  });
}

double packet_survey::reported_hz() const noexcept {
  if (zero_packets == 0) return 0.0;
  return static_cast<double>(reported_chz_) / 100.0 / static_cast<double>(zero_packets);
}

}  // namespace g4_tool::acceptance
