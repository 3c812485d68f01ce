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
#include "g4lidar/detail/saturating.hpp"
#include "packet_encoder.hpp"
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
  const std::int64_t at = (time_ns % (4 * quarter) + quarter) % (4 * quarter);
  const std::int64_t height = at < 2 * quarter ? at - quarter : 3 * quarter - at;
  return static_cast<double>(height) / static_cast<double>(quarter);
}

// The true sample rate in 0.001 Hz.
std::uint64_t true_rate_mhz(const scanner_options& options, std::int64_t time_ns) noexcept {
  const double drift = options.sample_rate_drift_ppm * 1e-6 * slow_wave(time_ns);
  const double nominal = 1000.0 * to_hz(options.sample_rate);
  const double rate_mhz = nominal * options.sample_rate_ratio * (1.0 + drift) + 0.5;
  return std::max<std::uint64_t>(static_cast<std::uint64_t>(rate_mhz), 1);
}

// Walls reflect 0.3 to 0.9 of what a perfectly bright one does, and of that half comes back from 4 m.
std::uint16_t intensity_of(const sighting& target, const sample_code& code) noexcept {
  const double reflected = 0.3 + 0.15 * (target.wall % 5);
  const double far = target.range_mm / 4000.0;
  return static_cast<std::uint16_t>(code.brightest() * reflected / (1.0 + far * far) + 0.5);
}

// A few samples have more flags than most. Also some without a return have flags.
std::uint8_t flags_of(const sample_truth& sample, std::uint8_t usual) noexcept {
  if (sample.raw != 0) return sample.index % 21 == 0 ? usual | 1U : usual;
  if (sample.index % 37 == 0) return 3;
  return sample.index % 13 == 0 ? 1 : 0;
}

std::string_view problem_with(const wire_format& format, const scanner_options& options) noexcept {
  const bool has_rate =
      options.sample_rate != sample_rate{} &&
      std::ranges::find(format.rates_hz, to_hz(options.sample_rate)) != format.rates_hz.end();
  const sample_code& code = format.code;
  if (!has_rate || code.intensity_bytes > 2 || code.units_per_mm == 0 ||
      code.size() * format.max_samples > longest_packet - packet_head_bytes) {
    return "the format must have the sample rate, and packets that fit";
  }
  return {};
}

}  // namespace

std::string_view problem_with(const scanner_options& options) noexcept {
  const wire_format& format = options.format;
  if (const std::string_view problem = problem_with(format, options); !problem.empty()) {
    return problem;
  }
  if (options.scan_frequency_chz < format.min_frequency_chz ||
      options.scan_frequency_chz > format.max_frequency_chz) {
    return "the scan frequency must be possible for the model";
  }
  if (options.samples_per_packet < 1 || options.samples_per_packet > format.max_samples) {
    return "a packet must hold 1 to 80 samples, or 40, by the model";
  }
  if (!(options.zero_deg >= -360.0 && options.zero_deg <= 360.0)) {
    return "the direction of zero must be -360 to 360 degrees";
  }
  if (!is_angle(options.index_deg)) return "the index angle must be 0 to below 360 degrees";
  if (options.start_deg && !is_angle(*options.start_deg)) {
    return "the start angle must be 0 to below 360 degrees";
  }
  const double unit_mm = 1.0 / format.code.units_per_mm;
  if (!(options.min_range_mm >= unit_mm && options.max_range_mm >= options.min_range_mm &&
        options.max_range_mm <= format.code.largest() * unit_mm)) {
    return "the ranges must be such as samples of the model can contain, the least first";
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
      caster_(scene, options.format.beam, options.format.is_turned),
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
  const std::uint64_t since_ns =
      since / rate_mhz_ * ns_by_mhz + since % rate_mhz_ * ns_by_mhz / rate_mhz_;
  return detail::saturating_add(since_ns_, static_cast<std::int64_t>(since_ns));
}

void scanner::resume(std::int64_t at_ns, std::uint64_t phase) noexcept {
  since_ns_ = at_ns;
  index_then_ = index_;
  phase_ = phase;
  at_index_ = false;
  since_zero_ = options_.information.size();
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
  const std::uint8_t before = crc_;
  const std::uint8_t ct = next_ct(zero);
  crc_ = crc_with(zero ? std::uint8_t{0} : crc_, ct);
  const std::span<const sample_truth> samples(truths_.data(), count);
  return {encode_packet(packet_, ct, samples, options_.format.code, options_.zero_deg), samples,
          samples.back().time_ns, before};
}

sample_truth scanner::measure() noexcept {
  sample_truth truth{};
  truth.index = index_;
  truth.time_ns = next_sample_ns();
  truth.revolution = revolution_;
  const double since_index = static_cast<double>(phase_ >> 11) * 0x1p-53 * 360.0;
  truth.first_level_deg = wrap_once_deg(options_.index_deg + since_index);
  const wire_format& format = options_.format;
  truth.bearing_deg = wrap_once_deg(truth.first_level_deg + format.beam.far_deg);
  truth.lidar = caster_.lidar_at(truth.time_ns);
  const bool is_mirrored = turning_ == turning::mirrored;
  const std::optional<sighting> target =
      caster_.cast(truth.first_level_deg, truth.lidar, truth.time_ns, is_mirrored);
  if (target) {
    truth.bearing_deg = target->bearing_deg;
    truth.range_mm = target->range_mm;
  }
  truth.raw = raw_sample(truth.range_mm);
  if (target && truth.raw != 0) truth.intensity = intensity_of(*target, format.code);
  if (format.code.lower == lower_bits::flags) truth.flags = flags_of(truth, format.usual_flags);
  return truth;
}

// Each sample draws the same number of random numbers for every target and every option, so that a
// change in one place changes nothing elsewhere.
std::uint16_t scanner::raw_sample(double range_mm) noexcept {
  const double error = noise_.gaussian();
  const bool dropped = dropouts_.uniform() < options_.dropout_ratio;
  const auto is_seen = [this](double mm) {
    return mm >= options_.min_range_mm && mm <= options_.max_range_mm;
  };
  if (dropped || !is_seen(range_mm)) return 0;
  const double spread = options_.noise_mm + options_.noise_ratio * range_mm;
  const double measured = range_mm + error * spread;
  if (!is_seen(measured)) return 0;
  return static_cast<std::uint16_t>(measured * options_.format.code.units_per_mm + 0.5);
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

std::uint8_t scanner::next_ct(bool zero) noexcept {
  since_zero_ = zero ? 0 : since_zero_ + 1;
  if (!zero) {
    const bool has_more = since_zero_ <= options_.information.size();
    const unsigned more = has_more ? options_.information[since_zero_ - 1] : 0U;
    return static_cast<std::uint8_t>((options_.ordinary_ct | more) & 0xFEU);
  }
  if (!options_.reports_frequency) return 1;
  const auto frequency_dhz = static_cast<int>((speed_mhz_ + 50U) / 100U);
  const int reported = std::clamp(frequency_dhz - options_.format.ct_offset_chz / 10, 0, 127);
  return static_cast<std::uint8_t>(reported * 2 + 1);
}

}  // namespace g4lidar::sim
