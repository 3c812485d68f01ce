// SPDX-License-Identifier: MIT
// The rotating head: the angle is a 64-bit phase that wraps by itself, so that no error accumulates
// and the index passes exactly where the phase overflows.
#include "sim/exact.hpp"

#include "g4lidar/sim/scanner.hpp"

#include <algorithm>
#include <cassert>
#include <cstddef>

#include "g4lidar/core/angle.hpp"
#include "g4lidar/core/response.hpp"
#include "sim/purpose.hpp"

namespace g4lidar::sim {
namespace {

constexpr bool is_angle(double degrees) noexcept { return degrees >= 0.0 && degrees < 360.0; }

// floor(2^64 * numerator / denominator), for numerator < denominator < 2^32.
constexpr std::uint64_t fraction_of_turn(std::uint64_t numerator,
                                         std::uint64_t denominator) noexcept {
  const std::uint64_t high = (numerator << 32) / denominator;
  const std::uint64_t rest = (numerator << 32) % denominator;
  return (high << 32) | ((rest << 32) / denominator);
}

std::uint64_t first_phase(const scanner_options& options) noexcept {
  if (!options.start_deg) return stream_for(options.seed, purpose::start_angle).next();
  const double turn = wrap_once_deg(*options.start_deg - options.index_deg) / 360.0;
  return static_cast<std::uint64_t>(turn * 0x1p53) << 11;
}

// -1 to 1 and back in a minute, from 0 at time 0.
double slow_wave(std::int64_t time_ns) noexcept {
  constexpr std::int64_t quarter = 15'000'000'000;
  const std::int64_t at = (time_ns + quarter) % (4 * quarter);
  const std::int64_t height = at < 2 * quarter ? at - quarter : 3 * quarter - at;
  return static_cast<double>(height) / static_cast<double>(quarter);
}

// The true sample rate in 0.001 Hz.
std::uint64_t true_rate_mhz(const scanner_options& options, std::int64_t time_ns) noexcept {
  const double drift = options.sample_rate_drift_ppm * 1e-6 * slow_wave(time_ns);
  const double nominal = 1000.0 * to_hz(options.sample_rate);
  return static_cast<std::uint64_t>(nominal * options.sample_rate_ratio * (1.0 + drift) + 0.5);
}

// A wire angle: the nearest 1/64 of a degree, and the check bit.
std::uint16_t wire_angle(double degrees) noexcept {
  const auto nearest = static_cast<unsigned>(degrees * 64.0 + 0.5);
  return static_cast<std::uint16_t>((nearest % turn_64ths) << 1 | 1U);
}

}  // namespace

std::string_view problem_with(const scanner_options& options) noexcept {
  if (options.scan_frequency_chz < min_scan_frequency_chz ||
      options.scan_frequency_chz > max_scan_frequency_chz) {
    return "the scan frequency must be 5 to 12 Hz";
  }
  if (options.samples_per_packet < 1 || options.samples_per_packet > max_samples) {
    return "a packet must hold 1 to 80 samples";
  }
  if (!is_angle(options.index_deg)) return "the index angle must be 0 to below 360 degrees";
  if (options.start_deg && !is_angle(*options.start_deg)) {
    return "the start angle must be 0 to below 360 degrees";
  }
  if (!(options.min_range_mm >= 0.25 && options.max_range_mm >= options.min_range_mm &&
        options.max_range_mm <= 16383.75)) {
    return "the ranges must be 0.25 to 16383.75 mm, the least first";
  }
  if (!(options.noise_mm >= 0.0 && options.noise_mm <= 1e6 && options.noise_ratio >= 0.0 &&
        options.noise_ratio <= 1.0)) {
    return "the noise must be 0 to 1000000 mm and 0 to 1 of the range";
  }
  if (!(options.dropout_ratio >= 0.0 && options.dropout_ratio <= 1.0)) {
    return "the dropouts must be 0 to 1 of all samples";
  }
  if (!(options.sample_rate_ratio >= 0.9 && options.sample_rate_ratio <= 1.1)) {
    return "the true sample rate must be 0.9 to 1.1 of the nominal one";
  }
  if (!(options.sample_rate_drift_ppm >= 0.0 && options.sample_rate_drift_ppm <= 10'000.0)) {
    return "the sample rate must drift by 0 to 10000 millionths";
  }
  return {};
}

bytes scan_start_reply() noexcept { return response_layouts[0].header; }
static_assert(response_layouts[0].kind == response_kind::scan_started);

scanner::scanner(const world& scene, const scanner_options& options)
    : options_(options),
      caster_(scene),
      noise_(stream_for(options.seed, purpose::noise)),
      dropouts_(stream_for(options.seed, purpose::dropouts)),
      speed_mhz_(options.scan_frequency_chz * std::uint32_t{10}),
      rate_mhz_(true_rate_mhz(options, 0)),
      phase_(first_phase(options)),
      step_(fraction_of_turn(speed_mhz_, rate_mhz_)),
      at_index_(phase_ < step_) {
  assert(problem_with(options).empty());
}

void scanner::set_step() noexcept { step_ = fraction_of_turn(speed_mhz_, rate_mhz_); }

void scanner::set_speed_mhz(std::uint32_t speed_mhz) noexcept {
  if (speed_mhz == speed_mhz_) return;
  speed_mhz_ = speed_mhz;
  set_step();
}

void scanner::set_sample_rate(sample_rate rate) noexcept { options_.sample_rate = rate; }

std::int64_t scanner::next_sample_ns() const noexcept {
  const std::uint64_t since = index_ - index_then_;
  constexpr std::uint64_t ns_by_mhz = 1'000'000'000'000;
  return since_ns_ + static_cast<std::int64_t>(since / rate_mhz_ * ns_by_mhz +
                                               since % rate_mhz_ * ns_by_mhz / rate_mhz_);
}

void scanner::resume(std::int64_t at_ns, std::uint64_t phase) noexcept {
  since_ns_ = at_ns;
  index_then_ = index_;
  phase_ = phase;
  at_index_ = false;
}

// A packet's samples are equidistant: whatever changes, changes between packets.
void scanner::keep_rate() noexcept {
  const std::int64_t at_ns = next_sample_ns();
  const std::uint64_t rate_mhz = true_rate_mhz(options_, at_ns);
  if (rate_mhz == rate_mhz_) return;
  since_ns_ = at_ns;
  index_then_ = index_;
  rate_mhz_ = rate_mhz;
  set_step();
}

sent_packet scanner::next() noexcept {
  keep_rate();
  const bool zero = at_index_;
  if (zero && index_ != 0) ++revolution_;
  const std::size_t at_most = zero ? 1 : options_.samples_per_packet;
  std::size_t count = 0;
  do {
    truths_[count++] = measure();
    turn_on();
  } while (count < at_most && !at_index_);
  return {packet_of(count, zero), {truths_.data(), count}, truths_[count - 1].time_ns};
}

sample_truth scanner::measure() noexcept {
  sample_truth truth{};
  truth.index = index_;
  truth.time_ns = next_sample_ns();
  truth.revolution = revolution_;
  const double since_index = static_cast<double>(phase_ >> 11) * 0x1p-53 * 360.0;
  truth.first_level_deg = wrap_once_deg(options_.index_deg + since_index);
  truth.bearing_deg = wrap_once_deg(truth.first_level_deg + far_correction_deg);
  truth.lidar = caster_.lidar_at(truth.time_ns);
  const bool is_mirrored = turning_ == turning::mirrored;
  if (const std::optional<sighting> target =
          caster_.cast(truth.first_level_deg, truth.lidar, truth.time_ns, is_mirrored)) {
    truth.bearing_deg = target->bearing_deg;
    truth.range_mm = target->range_mm;
  }
  truth.raw = raw_sample(truth.range_mm);
  return truth;
}

// Each sample draws the same number of random numbers for every target and every option, so that a
// change in one place changes nothing elsewhere.
std::uint16_t scanner::raw_sample(double range_mm) noexcept {
  const double error = noise_.gaussian();
  const bool dropped = dropouts_.uniform() < options_.dropout_ratio;
  if (dropped || range_mm < options_.min_range_mm || range_mm > options_.max_range_mm) return 0;
  const double spread = options_.noise_mm + options_.noise_ratio * range_mm;
  const double measured = range_mm + error * spread;
  if (measured < options_.min_range_mm || measured > options_.max_range_mm) return 0;
  return static_cast<std::uint16_t>(measured * 4.0 + 0.5);
}

void scanner::turn_on() noexcept {
  ++index_;
  if (turning_ == turning::falling) {
    at_index_ = phase_ < step_;  // it is about to wrap
    phase_ -= step_;
  } else {
    phase_ += step_;
    at_index_ = phase_ < step_;  // it has wrapped
  }
}

bytes scanner::packet_of(std::size_t samples, bool zero) noexcept {
  const std::span<std::uint8_t> out(packet_);
  const unsigned frequency_dhz = std::min((speed_mhz_ + 50U) / 100U, 127U);
  const unsigned reported = options_.reports_frequency ? frequency_dhz : 0U;
  const unsigned ordinary = options_.ordinary_ct & 0xFEU;
  packet_[0] = packet_start[0];
  packet_[1] = packet_start[1];
  packet_[2] = static_cast<std::uint8_t>(zero ? reported << 1 | 1U : ordinary);
  packet_[3] = static_cast<std::uint8_t>(samples);
  store_u16(out, 4, wire_angle(truths_[0].first_level_deg));
  store_u16(out, 6, wire_angle(truths_[samples - 1].first_level_deg));
  for (std::size_t i = 0; i < samples; ++i) {
    store_u16(out, packet_size(i), truths_[i].raw);
  }
  const bytes packet = bytes(packet_).first(packet_size(samples));
  store_u16(out, 8, packet_checksum(packet));
  return packet;
}

}  // namespace g4lidar::sim
