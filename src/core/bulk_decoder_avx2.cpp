// SPDX-License-Identifier: MIT
// The kernels of the bulk decoder for processors with AVX2 and FMA; compiled without special flags.
#include "bulk_kernels.hpp"

#if G4LIDAR_HAS_AVX2_KERNELS

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <limits>
#include <numbers>

#include "avx2.hpp"
#include "g4lidar/core/correction.hpp"
#include "g4lidar/core/decode.hpp"

// Each kernel processes the packet several times, with a few instructions per group of eight
// samples. A single pass would be a chain of about sixty instructions, and the processor, which
// looks ahead only so far, would wait for each result: that takes twice as long.

namespace g4lidar::bulk {

namespace {

using namespace avx2;

/// For samples without return. `quarters` are ranges.
template <sample_layout Layout>
G4LIDAR_AVX2 words none(words quarters) {
  return less(quarters, every(range_word<Layout>::least));
}

/// The second-level correction of samples from 100 mm on, in quarters of a millimetre. As in compact_correction it is computed
/// from its middle; but the remaining corrections are within 6.3 degrees of the middle, so three
/// terms of the series are sufficient for 3e-8 degrees.
constexpr std::uint32_t nearest_raw = 400;
static_assert(nearest_raw == 4 * g4_model.range.min_mm);

G4LIDAR_AVX2 floats triangle_correction(floats sample) {
  const floats t = (every(797.3080408F) - sample) /
                   times_plus(every(9.183236226F), sample, every(-24.72089691F));
  const floats x = t * t;
  floats series = times_plus(x, every(11.291349704F), every(-19.097602652F));
  series = times_plus(x, series, every(57.295778049F));
  return times_plus(t, series, every(-1.77591265498F));
}

/// That of an SCL: three terms of the arctangent after the first are sufficient for 2e-6 degrees.
G4LIDAR_AVX2 floats scl_correction(floats sample) {
  constexpr auto degrees = static_cast<float>(180.0 / std::numbers::pi);
  const floats t = every(71.2F) / sample;
  const floats x = t * t;
  floats series = times_plus(x, every(-degrees / 7), every(degrees / 5));
  series = times_plus(x, series, every(-degrees / 3));
  return t * times_plus(x, series, every(degrees));
}

/// Whether an angle of the packet can be outside [0, 360) before it is wrapped, if all its ranges
/// are 100 mm or more.
bool touches_zero(packet_view packet) noexcept {
  constexpr int before = 8 * 64;
  constexpr int behind = 5 * 64;
  const int begin = packet.first_angle_64ths();
  return begin < before || begin + packet.span_64ths() >= turn_64ths - behind;
}

/// wrap_once_deg(). As unsigned numbers, any negative float is greater than any positive one, so
/// the smaller one of x and x + 360, and then of that and 360 less, is the one in range.
G4LIDAR_AVX2 floats wrapped(floats x) {
  const words lifted = unsigned_min(bits_of(x), bits_of(x + every(360.0F)));
  return floats_of(unsigned_min(lifted, bits_of(floats_of(lifted) - every(360.0F))));
}

static_assert(offsetof(point, angle_deg) == 0 && offsetof(point, range_mm) == 4 &&
              offsetof(point, time_ns) == 8 && offsetof(point, revolution) == 16 &&
              offsetof(point, flags) == 20);

/// Four points of 24 bytes, assembled from pairs A (angle, range) and B (revolution, flags), and
/// the times T: in three registers A0 T0 B0 A1
/// T1 B1 A2 T2
/// B2 A3 T3 B3. This is the order in which no pair has to move: `a` holds A0 A3 A2 A1, `b` holds B2
/// B1 B0 B3, and `times` T1 T0 T3 T2.
constexpr lane_order point_order{0, 3, 4, 7, 2, 1, 6, 5};

G4LIDAR_AVX2 void store_four(__m256i a, __m256i b, __m256i times, point* out) {
  const __m256i first = _mm256_blend_epi32(a, b, 0b00110000);
  const __m256i second = _mm256_blend_epi32(a, b, 0b00001100);
  const __m256i third = _mm256_blend_epi32(b, a, 0b00001100);
  auto* const to = reinterpret_cast<__m256i*>(out);
  _mm256_storeu_si256(to, _mm256_blend_epi32(first, times, 0b00001100));
  _mm256_storeu_si256(to + 1, _mm256_blend_epi32(second, times, 0b11000011));
  _mm256_storeu_si256(to + 2, _mm256_blend_epi32(third, times, 0b00110000));
}

/// The times of the points, four at a time, as store_four() needs them: none, or those of a packet,
/// bit for bit like packet_times::at().
struct no_times {
  G4LIDAR_AVX2 __m256i next() { return _mm256_setzero_si256(); }
};
class running_times {
 public:
  G4LIDAR_AVX2 explicit running_times(const packet_times& times)
      : first_(_mm256_set1_epi64x(times.first_ns)) {
    const auto step = static_cast<long long>(times.step_ns * (1 << fraction_bits));
    way_ = _mm256_setr_epi64x(step, 0, 3 * step, 2 * step);
    ahead_ = _mm256_set1_epi64x(4 * step);
  }
  G4LIDAR_AVX2 __m256i next() {
    const __m256i now = _mm256_add_epi64(first_, _mm256_srli_epi64(way_, fraction_bits));
    way_ = _mm256_add_epi64(way_, ahead_);
    return now;
  }

 private:
  static constexpr int fraction_bits = 20;
  __m256i first_;
  __m256i way_;
  __m256i ahead_;
};

template <class Times>
G4LIDAR_AVX2 void store_eight(floats angle, floats range, words revolution, words flags,
                              Times& times, point* out) {
  const __m256i swapped = _mm256_permute2x128_si256(flags.v, flags.v, 1);
  store_four(_mm256_castps_si256(_mm256_unpacklo_ps(angle.v, range.v)),
             _mm256_unpacklo_epi32(revolution.v, swapped), times.next(), out);
  store_four(_mm256_castps_si256(_mm256_unpackhi_ps(angle.v, range.v)),
             _mm256_unpackhi_epi32(revolution.v, swapped), times.next(), out + 4);
}

/// False if there is a sample below 100 mm or `shortest_mm` whose angle has a correction, which is
/// rare: the portable kernel processes it.
template <sample_layout Layout, correction_kind Kind, class Times>
G4LIDAR_AVX2 bool convert(packet_view packet, std::uint32_t revolution, std::uint16_t shortest_mm,
                          Times times, std::span<point, max_samples> out) {
  constexpr bool has_correction = Kind != correction_kind::none;
  constexpr int least = range_word<Layout>::least;
  const eights<point_order, Layout> raw(packet);
  per_packet<floats> range;
  const first_level_angles<float> angles(packet);
  const floats first = every(angles.first);
  const floats step = every(angles.step);
  per_packet<floats> angle;
  const floats far = every(static_cast<float>(no_return_correction_deg(Kind)));
  // Less the least range, as unsigned: so that no return is the farthest.
  words nearest = every(-1);
  for (std::size_t i = 0; i < raw.count(); ++i) {
    const words quarters = raw.quarters(i);
    const floats sample = to_floats(quarters);
    const words no_return = none<Layout>(quarters);
    range[i] = floats_of(without(no_return, bits_of(sample * every(0.25F))));
    if constexpr (has_correction) {
      nearest = unsigned_min(nearest, quarters - every(least));
      const floats found =
          Kind == correction_kind::scl ? scl_correction(sample) : triangle_correction(sample);
      angle[i] = first + times_plus(raw.places(i), step, choose(no_return, found, far));
    } else {
      angle[i] = times_plus(raw.places(i), step, first);
    }
  }
  if constexpr (has_correction) {
    const int shortest = std::max<int>(nearest_raw, 4 * shortest_mm) - least;
    if (any(equal(unsigned_min(nearest, every(shortest - 1)), nearest))) return false;
  }
  if (touches_zero(packet)) {
    for (std::size_t i = 0; i < raw.count(); ++i) angle[i] = wrapped(angle[i]);
  }
  const words revolutions = every(static_cast<int>(revolution));
  for (std::size_t i = 0; i < raw.count(); ++i) {
    static_assert(static_cast<int>(point_flags::no_return) == 1);
    const words quarters = raw.quarters(i);
    words flags = every(0) - none<Layout>(quarters);
    if constexpr (!has_correction) {  // else there is none that is too near
      static_assert(static_cast<int>(point_flags::too_near) == 2);
      flags = (less(quarters, every(4 * shortest_mm)) & every(2)) - flags;
    }
    if constexpr (Layout != g4_layout) flags = flags | raw.others(i);
    store_eight(angle[i], range[i], revolutions, flags, times, out.data() + lanes * i);
  }
  if (packet.is_zero()) out[0].flags = out[0].flags | point_flags::revolution_start;
  return true;
}

/// See sine_cosine_deg().
struct direction {
  floats sine;
  floats cosine;
};
G4LIDAR_AVX2 direction direction_of(floats degrees) {
  const words quarter = to_nearest(degrees * every(1.0F / 90.0F));
  const floats x = minus_times(to_floats(quarter), every(90.0F), degrees) *
                   every(std::numbers::pi_v<float> / 180.0F);
  const floats x2 = x * x;
  floats s = times_plus(x2, every(2.7525562e-6F), every(-1.9840874e-4F));
  floats c = times_plus(x2, every(2.4760495e-5F), every(-1.3888885e-3F));
  s = times_plus(x2, s, every(8.3333310e-3F));
  c = times_plus(x2, c, every(4.1666666e-2F));
  s = times_plus(x2, s, every(-1.6666667e-1F));
  c = times_plus(x2, c, every(-0.5F));
  s = times_plus(x * x2, s, x);
  c = times_plus(x2, c, every(1.0F));
  // An odd number of quarters swaps the two; bit 1 of the number inverts the sign of the sine, and
  // bit 1 of the next number that of the cosine.
  const words odd = shifted_left<31>(quarter);
  const words sign = every(std::numeric_limits<int>::min());
  const words sine_sign = shifted_left<30>(quarter) & sign;
  const words cosine_sign = shifted_left<30>(quarter + every(1)) & sign;
  return {floats_of(bits_of(choose(odd, s, c)) ^ sine_sign),
          floats_of(bits_of(choose(odd, c, s)) ^ cosine_sign)};
}

static_assert(offsetof(xy_point, x_m) == 0 && offsetof(xy_point, y_m) == 4 &&
              offsetof(xy_point, time_ns) == 8);

/// Eight positions of 16 bytes, two per register.
constexpr lane_order xy_order{0, 2, 4, 6, 1, 3, 5, 7};

G4LIDAR_AVX2 void store_eight(floats x, floats y, xy_point* out) {
  const __m256i zero = _mm256_setzero_si256();
  const __m256i low = _mm256_castps_si256(_mm256_unpacklo_ps(x.v, y.v));
  const __m256i high = _mm256_castps_si256(_mm256_unpackhi_ps(x.v, y.v));
  auto* const to = reinterpret_cast<__m256i*>(out);
  _mm256_storeu_si256(to, _mm256_unpacklo_epi64(low, zero));
  _mm256_storeu_si256(to + 1, _mm256_unpackhi_epi64(low, zero));
  _mm256_storeu_si256(to + 2, _mm256_unpacklo_epi64(high, zero));
  _mm256_storeu_si256(to + 3, _mm256_unpackhi_epi64(high, zero));
}

/// The directions of all samples of a packet: each is that of the first of its group of eight,
/// rotated by the difference. Ten and eight directions take much less time than eighty.
class directions {
 public:
  G4LIDAR_AVX2 directions(floats first, floats step, std::size_t eights_in_all)
      : in_eight_(direction_of(eights<xy_order, g4_layout>::places(0) * step)) {
    const floats ahead = every(8.0F) * step;
    const words count{_mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7)};
    for (std::size_t i = 0; i < eights_in_all; i += lanes) {
      const words eight = count + every(static_cast<int>(i));
      const direction some = direction_of(times_plus(to_floats(eight), ahead, first));
      _mm256_storeu_ps(sines_.data() + i, some.sine.v);
      _mm256_storeu_ps(cosines_.data() + i, some.cosine.v);
    }
  }

  [[nodiscard]] G4LIDAR_AVX2 direction operator[](std::size_t i) const {
    const floats s = every(sines_[i]);
    const floats c = every(cosines_[i]);
    return {times_plus(s, in_eight_.cosine, c * in_eight_.sine),
            times_minus(c, in_eight_.cosine, s * in_eight_.sine)};
  }

 private:
  direction in_eight_;
  std::array<float, 2 * lanes> sines_;
  std::array<float, 2 * lanes> cosines_;
};

/// No arctangent is needed: the correction is an angle in the right-angled triangle with the legs d
/// and u = 21.8 - (21.8 / 155.3) d, so the range along the first-level angle and across it follow
/// from the sides, and a rotation by that angle is sufficient. Of an SCL u is 17.8. In the robot's frame angles grow in
/// the other direction, from `turn_deg` on.
template <sample_layout Layout, correction_kind Kind>
G4LIDAR_AVX2 void convert_to_xy(packet_view packet, frame to, std::uint16_t turn_deg,
                                std::span<xy_point, max_samples> out) noexcept {
  constexpr bool is_scl = Kind == correction_kind::scl;
  constexpr auto offset_raw = static_cast<float>(is_scl ? 71.2 : 4.0 * correction_offset_mm);
  constexpr auto slope =
      static_cast<float>(is_scl ? 0.0 : -correction_offset_mm / correction_zero_mm);
  constexpr float metres = 0.00025F;  // a quarter of a millimetre
  const bool mirrored = to == frame::robot;
  const float sign = mirrored ? -1.0F : 1.0F;
  const first_level_angles<float> angles(packet);
  const eights<xy_order, Layout> raw(packet);
  per_packet<floats> along;
  per_packet<floats> across;
  for (std::size_t i = 0; i < raw.count(); ++i) {
    const words quarters = raw.quarters(i);
    const floats d = to_floats(quarters);
    if constexpr (Kind == correction_kind::none) {
      along[i] = floats_of(bits_of(d * every(metres)) | none<Layout>(quarters));
    } else {
      const floats u = times_plus(d, every(slope * sign), every(offset_raw * sign));
      const floats share = d * every(metres) / square_root(times_plus(d, d, u * u));
      const floats share_or_nan = floats_of(bits_of(share) | none<Layout>(quarters));
      along[i] = share_or_nan * d;
      across[i] = share_or_nan * u;
    }
  }
  const directions turn(
      every(mirrored ? static_cast<float>(turn_deg) - angles.first : angles.first),
      every(angles.step * sign), raw.count());
  for (std::size_t i = 0; i < raw.count(); ++i) {
    const auto [sine, cosine] = turn[i];
    xy_point* const here = out.data() + lanes * i;
    if constexpr (Kind == correction_kind::none) {
      store_eight(along[i] * cosine, along[i] * sine, here);
    } else {
      store_eight(times_minus(along[i], cosine, across[i] * sine),
                  times_plus(along[i], sine, across[i] * cosine), here);
    }
  }
}

template <sample_layout Layout, correction_kind Kind>
struct avx2_kernels {
  __attribute__((target("avx2,fma"))) static void to_points(
      packet_view packet, std::uint32_t revolution, std::uint16_t shortest_mm,
      std::span<point, max_samples> out) noexcept {
    if (!convert<Layout, Kind>(packet, revolution, shortest_mm, no_times(), out)) {
      portable().to_points(packet, revolution, shortest_mm, out);
    }
  }
  __attribute__((target("avx2,fma"))) static void to_timed_points(
      packet_view packet, std::uint32_t revolution, std::uint16_t shortest_mm,
      const packet_times& times, std::span<point, max_samples> out) noexcept {
    if (!convert<Layout, Kind>(packet, revolution, shortest_mm, running_times(times), out)) {
      portable().to_timed_points(packet, revolution, shortest_mm, times, out);
    }
  }
  __attribute__((target("avx2,fma"))) static void to_xy(
      packet_view packet, frame to, std::uint16_t turn_deg,
      std::span<xy_point, max_samples> out) noexcept {
    convert_to_xy<Layout, Kind>(packet, to, turn_deg, out);
  }
  static const kernels& portable() noexcept {
    return kernels_of(instruction_set::portable, {Layout, Kind});
  }
  static constexpr kernels all{to_points, to_timed_points, to_xy};
};

}  // namespace

const kernels& avx2_kernels_of(sample_format format) noexcept {
  const kernels* const found = find_kernels<avx2_kernels>(format);
  assert(found != nullptr);
  return *found;
}

}  // namespace g4lidar::bulk

#endif
