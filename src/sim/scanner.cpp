// SPDX-License-Identifier: MIT
// The turning head: the angle is a 64-bit phase that wraps by itself, so that no error adds up and
// the index passes exactly where the phase overflows.
#include "exact.hpp"

#include "g4lidar/sim/scanner.hpp"

#include <cassert>
#include <cstddef>

#include "g4lidar/angle.hpp"
#include "g4lidar/response.hpp"

namespace g4lidar::sim {
namespace {

// What the random streams of a scanner are for. The numbers are part of the golden digests.
enum class purpose : std::uint64_t { start_angle = 1, noise = 2, dropouts = 3 };

random_stream stream_for(const scanner_options& options, purpose what) noexcept {
  return random_stream(options.seed, static_cast<std::uint64_t>(what));
}

constexpr bool is_angle(double degrees) noexcept { return degrees >= 0.0 && degrees < 360.0; }

// floor(2^64 * numerator / denominator), for numerator < denominator < 2^32.
constexpr std::uint64_t fraction_of_turn(std::uint64_t numerator,
                                         std::uint64_t denominator) noexcept {
  const std::uint64_t high = (numerator << 32) / denominator;
  const std::uint64_t rest = (numerator << 32) % denominator;
  return (high << 32) | ((rest << 32) / denominator);
}

std::uint64_t first_phase(const scanner_options& options) noexcept {
  if (!options.start_deg) return stream_for(options, purpose::start_angle).next();
  const double turn = wrap_once_deg(*options.start_deg - options.index_deg) / 360.0;
  return static_cast<std::uint64_t>(turn * 0x1p53) << 11;
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
  return {};
}

bytes scan_start_reply() noexcept { return response_layouts[0].header; }
static_assert(response_layouts[0].kind == response_kind::scan_started);

scanner::scanner(const world& scene, const scanner_options& options)
    : options_(options),
      caster_(scene),
      noise_(stream_for(options, purpose::noise)),
      dropouts_(stream_for(options, purpose::dropouts)),
      rate_hz_(samples_per_second(options.ranging)),
      phase_(first_phase(options)),
      step_(fraction_of_turn(options.scan_frequency_chz, std::uint64_t{100} * rate_hz_)),
      at_index_(phase_ < step_) {
  assert(problem_with(options).empty());
}

sent_packet scanner::next() noexcept {
  const bool zero = at_index_;
  if (zero && index_ != 0) ++revolution_;
  const std::size_t at_most = zero ? 1 : options_.samples_per_packet;
  std::size_t count = 0;
  do {
    truths_[count++] = measure();
    turn_on();
  } while (count < at_most && !at_index_);
  return {frame_of(count, zero), {truths_.data(), count}, truths_[count - 1].time_ns};
}

sample_truth scanner::measure() noexcept {
  sample_truth truth{};
  truth.index = index_;
  truth.time_ns = static_cast<std::int64_t>(index_ / rate_hz_ * 1'000'000'000U +
                                            index_ % rate_hz_ * 1'000'000'000U / rate_hz_);
  truth.revolution = revolution_;
  const double since_index = static_cast<double>(phase_ >> 11) * 0x1p-53 * 360.0;
  truth.first_level_deg = wrap_once_deg(options_.index_deg + since_index);
  truth.bearing_deg = wrap_once_deg(truth.first_level_deg + far_correction_deg);
  if (const std::optional<sighting> target = caster_.cast(truth.first_level_deg)) {
    truth.bearing_deg = target->bearing_deg;
    truth.range_mm = target->range_mm;
  }
  truth.raw = raw_sample(truth.range_mm);
  return truth;
}

// Each sample draws as many random numbers whatever it meets and however the options are set, so
// that a change in one place moves nothing anywhere else.
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
  phase_ += step_;
  at_index_ = phase_ < step_;  // it has wrapped
}

bytes scanner::frame_of(std::size_t samples, bool zero) noexcept {
  const std::span<std::uint8_t> out(frame_);
  const unsigned frequency_dhz = (options_.scan_frequency_chz + 5U) / 10U;
  const unsigned reported = options_.reports_frequency ? frequency_dhz : 0U;
  frame_[0] = packet_start[0];
  frame_[1] = packet_start[1];
  frame_[2] = static_cast<std::uint8_t>(zero ? reported << 1 | 1U : 0U);
  frame_[3] = static_cast<std::uint8_t>(samples);
  store_u16(out, 4, wire_angle(truths_[0].first_level_deg));
  store_u16(out, 6, wire_angle(truths_[samples - 1].first_level_deg));
  for (std::size_t i = 0; i < samples; ++i) {
    store_u16(out, packet_size(i), truths_[i].raw);
  }
  const bytes frame = bytes(frame_).first(packet_size(samples));
  store_u16(out, 8, packet_checksum(frame));
  return frame;
}

}  // namespace g4lidar::sim
