// SPDX-License-Identifier: MIT
// The source of the kernels of the bulk decoder, for every layout of samples and every processor. A
// file that includes it compiles them for one instruction set: see bulk_vectors.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

#include "bulk_kernels.hpp"
#include "bulk_vectors.hpp"
#include "g4lidar/core/correction.hpp"
#include "g4lidar/core/decode.hpp"

// There is no fused multiply-add, and no number depends on those in other lanes: the same bytes give
// the same points and positions, to the last bit, with every instruction set.

namespace g4lidar::bulk {

/// For packets with a very near return, one sample at a time.
template <sample_layout Layout, correction_kind Kind>
struct plain {
  using form = std::conditional_t<
      Kind == correction_kind::triangle, compact_correction,
      std::conditional_t<Kind == correction_kind::scl, scl_correction, no_correction>>;

  [[gnu::noinline]] static void to_points(packet_view packet, std::uint32_t revolution,
                                          std::uint16_t shortest_mm, const packet_times& times,
                                          std::span<point, max_samples> out) noexcept {
    static_cast<void>(decode<Layout>(packet, form{}, revolution, out, shortest_mm));
    times.write_to(out.first(packet.sample_count()));
  }
  [[gnu::noinline]] static void to_xy(packet_view packet, frame to, std::uint16_t turn_deg,
                                      std::span<xy_point, max_samples> out) noexcept {
    std::array<point, max_samples> points;
    to_points(packet, 0, 1, {}, points);
    g4lidar::to_xy(std::span(points).first(packet.sample_count()), to, out, turn_deg);
  }
};

namespace {

constexpr std::size_t most_groups = max_samples / lanes;
static_assert(max_samples % lanes == 0);

/// Where the members of a point are in its last word.
constexpr bool is_little = std::endian::native == std::endian::little;
constexpr int flags_at = is_little ? 0 : 24;
constexpr int sample_flags_at = is_little ? 8 : 16;
constexpr int intensity_at = is_little ? 16 : 0;

/// The tangent of the correction is 21.8 / d - 21.8 / 155.3, of an SCL 17.8 / d. From 100 mm on it is
/// at most 0.178, so three terms of a series are sufficient for 2e-6 degrees. It is multiplied by a
/// number that makes the last coefficient 1.
constexpr int nearest_raw = 400;
static_assert(nearest_raw == 4 * g4_model.range.min_mm);
constexpr double tangent_scale = 1.6177563212028743;
template <correction_kind Kind>
constexpr auto tangent_by_raw = static_cast<float>(
    4.0 * tangent_scale * (Kind == correction_kind::scl ? 17.8 : correction_offset_mm));
template <correction_kind Kind>
constexpr auto far_tangent =
    Kind == correction_kind::scl
        ? 0.0F
        : static_cast<float>(-tangent_scale * correction_offset_mm / correction_zero_mm);
G4LIDAR_KERNEL floats arctangent_deg(floats x) {
  const floats x2 = x * x;
  return x * (x2 * (x2 + -4.509834285879194F) + 35.416812111098366F);
}

/// The samples of a packet in groups, one group in the lanes of a vector; zeros behind the last sample.
template <sample_layout Layout, correction_kind Kind>
class samples {
 public:
  G4LIDAR_KERNEL samples(packet_view packet, std::uint16_t shortest_mm)
      : angles_(packet), count_((packet.sample_count() + lanes - 1) / lanes) {
    const std::uint8_t* const data = packet.data().data() + packet_header_size;
    const std::size_t whole = packet.sample_count() / lanes;
    for (std::size_t i = 0; i < whole; ++i) raw_[i] = loaded(data + size * lanes * i, every_lane);
    if (whole < count_) {
      std::array<std::uint8_t, 1 + size * lanes> last{};
      std::memcpy(&last[1], data + size * lanes * whole, size * (packet.sample_count() % lanes));
      raw_[whole] = loaded(&last[1], every_lane);
    }
    const auto shortest = static_cast<float>(std::max<int>(nearest_raw, 4 * shortest_mm));
    limit_ = tangent_by_raw<Kind> / shortest;
  }

  static constexpr bool has_correction = Kind != correction_kind::none;
  /// Whether the angle of a sample below 100 mm or `shortest_mm` has a correction, which is rare: then
  /// its angle is wrong.
  [[nodiscard]] G4LIDAR_KERNEL bool has_near() const {
    return has_correction && any(largest_ > limit_);
  }
  /// The number of groups.
  [[nodiscard]] std::size_t count() const noexcept { return count_; }

  /// The ranges of group `i`, in quarters of a millimetre.
  [[nodiscard]] G4LIDAR_KERNEL words quarters(std::size_t i) const {
    using enum sample_layout;
    if constexpr (Layout == flagged_mm) return raw_[i] & 0xFFFC;
    if constexpr (size == 3) return raw_[i] >> 8 & 0xFFFC;
    if constexpr (Layout == intensity_16) return raw_[i] >> 14 & 0x3FFFC;
    return raw_[i] * range_word<Layout>::unit;
  }
  /// Whether they are ranges, as a mask.
  [[nodiscard]] G4LIDAR_KERNEL words returned(std::size_t i) const {
    return quarters(i) > range_word<Layout>::least - 1;
  }
  /// What the samples have beside the range, as in the last word of a point.
  [[nodiscard]] G4LIDAR_KERNEL words others(std::size_t i) const {
    using enum sample_layout;
    if constexpr (Layout == flagged_mm) return (raw_[i] & 3) << sample_flags_at;
    if constexpr (Layout == intensity_8) {
      return (raw_[i] >> 8 & 3) << sample_flags_at | (raw_[i] & 0xFF) << intensity_at;
    }
    if constexpr (Layout == intensity_10) return (raw_[i] & 0x3FF) << intensity_at;
    if constexpr (Layout == intensity_16) return (raw_[i] & 0xFFFF) << intensity_at;
    return words{};
  }
  /// The same as quarters(), as numbers.
  [[nodiscard]] G4LIDAR_KERNEL floats sample(std::size_t i) const {
    return __builtin_convertvector(quarters(i), floats);
  }
  /// In degrees, not wrapped.
  [[nodiscard]] G4LIDAR_KERNEL floats angle(std::size_t i) {
    floats turned = places(i) * angles_.step;
    if constexpr (has_correction) {
      const floats tangent = masked(returned(i), tangent_by_raw<Kind> / sample(i));
      largest_ = tangent > largest_ ? tangent : largest_;
      turned += arctangent_deg(tangent + far_tangent<Kind>);
    }
    return angles_.first + turned;
  }

 private:
  static constexpr std::size_t size = sample_size(Layout);

  /// In lanes of 32 bits, the first byte at the bottom. The byte before them is readable.
  template <std::size_t... i>
  [[nodiscard]] static G4LIDAR_KERNEL words loaded(const std::uint8_t* from,
                                                   std::index_sequence<i...> /*lanes*/) {
    // One expression with all lanes: compilers translate it to a load of all samples.
    return words{static_cast<std::int32_t>(sample_at(from + size * i))...};
  }
  [[nodiscard]] static G4LIDAR_KERNEL std::uint32_t sample_at(const std::uint8_t* from) {
    if constexpr (size == 2) return load_u16({from, size}, 0);
    if constexpr (size == 3) return load_u32({from - 1, size + 1}, 0) >> 8;
    return load_u32({from, size}, 0);
  }
  /// The indices of the samples of group `i`, as numbers.
  [[nodiscard]] static G4LIDAR_KERNEL floats places(std::size_t i) {
    static constexpr auto numbers = [] {
      std::array<float, max_samples> all{};
      for (std::size_t place = 0; place < all.size(); ++place)
        all[place] = static_cast<float>(place);
      return all;
    }();
    floats found;
    std::memcpy(&found, numbers.data() + lanes * i, sizeof found);
    return found;
  }

  first_level_angles<float> angles_;
  std::size_t count_;
  words raw_[most_groups];
  floats largest_{};  // tangent
  float limit_;
};

/// The times of the points, in the order of paired(), bit for bit like packet_times::at().
class running_times {
 public:
  G4LIDAR_KERNEL explicit running_times(const packet_times& times)
      : first_(pairs{} + static_cast<std::uint64_t>(times.first_ns)) {
    const auto step =
        static_cast<std::uint64_t>(static_cast<std::int64_t>(times.step_ns * (1 << fraction_bits)));
    for (std::size_t i = 0; i < lanes / 2; ++i) way_[0][i] = (i + i / 2 * 2) * step;
    way_[1] = way_[0] + 2 * step;
    ahead_ = pairs{} + lanes * step;
  }
  template <std::size_t half>
  G4LIDAR_KERNEL pairs next() {
    const pairs now = first_ + (way_[half] >> fraction_bits);
    way_[half] += ahead_;
    return now;
  }

 private:
  static constexpr int fraction_bits = 20;
  pairs first_;
  pairs way_[2];
  pairs ahead_;
};

static_assert(offsetof(point, angle_deg) == 0 && offsetof(point, range_mm) == 4 &&
              offsetof(point, time_ns) == 8 && offsetof(point, revolution) == 16 &&
              offsetof(point, flags) == 20 && offsetof(point, sample_flags) == 21 &&
              offsetof(point, intensity) == 22);

G4LIDAR_KERNEL void store_points(floats angle, floats range, words revolution, words flags,
                                 running_times& times, point* out) {
  const pairs a0 = paired<0>(angle, range);
  const pairs a1 = paired<1>(angle, range);
  const pairs b0 = paired<0>(revolution, flags);
  const pairs b1 = paired<1>(revolution, flags);
  const pairs t0 = times.next<0>();
  const pairs t1 = times.next<1>();
  store_blocks({joined<0, 0>(a0, t0), joined<0, 1>(b0, a0), joined<1, 1>(t0, b0),
                joined<0, 0>(a1, t1), joined<0, 1>(b1, a1), joined<1, 1>(t1, b1)},
               out);
}

/// Whether an angle of the packet can be outside [0, 360) before it is wrapped, if all its ranges
/// are 100 mm or more.
bool touches_zero(packet_view packet) noexcept {
  constexpr int before = 8 * 64;
  constexpr int behind = 11 * 64;
  const int begin = packet.first_angle_64ths();
  return begin < before || begin + packet.span_64ths() >= turn_64ths - behind;
}

/// wrap_once_deg().
G4LIDAR_KERNEL floats wrapped(floats x) {
  x += masked(x < 0.0F, floats{} + 360.0F);
  return x - masked(x >= 360.0F, floats{} + 360.0F);
}

/// This and write_places() are false if a sample is too near for the series.
template <sample_layout Layout, correction_kind Kind>
G4LIDAR_KERNEL bool write_points(packet_view packet, std::uint32_t revolution,
                                 std::uint16_t shortest_mm, running_times times, point* out) {
  samples<Layout, Kind> all(packet, shortest_mm);
  const bool wraps = touches_zero(packet);
  const words revolutions = words{} + static_cast<std::int32_t>(revolution);
  for (std::size_t i = 0; i < all.count(); ++i) {
    static_assert(static_cast<int>(point_flags::no_return) == 1 &&
                  static_cast<int>(point_flags::too_near) == 2);
    words flags = all.returned(i) + 1;
    if constexpr (!all.has_correction) {  // else there is none that is too near
      flags = ((all.quarters(i) < 4 * shortest_mm) & 2) - flags;
    }
    flags = flags << flags_at | all.others(i);
    floats angle = all.angle(i);
    if (wraps) angle = wrapped(angle);
    store_points(angle, masked(all.returned(i), all.sample(i) * 0.25F), revolutions, flags, times,
                 out + lanes * i);
  }
  if (packet.is_zero()) out[0].flags = out[0].flags | point_flags::revolution_start;
  return !all.has_near();
}

struct unit_vector {
  floats sine;
  floats cosine;
};
/// Of angles in half turns, within 1e-7.
G4LIDAR_KERNEL unit_vector direction_of(floats turned) {
  // The sum is rounded, because numbers of this size have no bits behind the point. Its last bit is
  // set if the number of half turns is odd.
  constexpr float rounding = 0x1.8p23F;
  const floats sum = turned + rounding;
  const floats x = turned - (sum - rounding);
  const floats x2 = x * x;
  const floats x4 = x2 * x2;
  const floats s = x * ((3.14159264F + x2 * -5.16771008F) +
                        x4 * ((2.55007739F + x2 * -0.598290411F) + x4 * 0.0776559123F));
  const floats c = (0.999999953F + x2 * -4.93479280F) +
                   x4 * ((4.05841079F + x2 * -1.33187297F) + x4 * 0.219682424F);
  const words sign = bits_of(sum) << 31;
  return {floats_of(bits_of(s) ^ sign), floats_of(bits_of(c) ^ sign)};
}

static_assert(offsetof(xy_point, x_m) == 0 && offsetof(xy_point, y_m) == 4 &&
              offsetof(xy_point, time_ns) == 8);

template <sample_layout Layout, correction_kind Kind>
G4LIDAR_KERNEL bool write_places(packet_view packet, frame to, std::uint16_t turn_deg,
                                 xy_point* out) {
  samples<Layout, Kind> all(packet, 1);
  // The frame of a robot is mirrored, and turned by 180 degrees or by none.
  const float half_turns = (to == frame::robot ? -1.0F : 1.0F) / 180.0F;
  const float metres = to == frame::robot && turn_deg != 0 ? -0.00025F : 0.00025F;
  // Two passes: a single one would be so long a chain that the processor, which looks ahead only so
  // far, would wait for each result.
  floats turned[most_groups];
  floats range[most_groups];
  for (std::size_t i = 0; i < all.count(); ++i) {
    turned[i] = all.angle(i) * half_turns;
    range[i] = floats_of(bits_of(all.sample(i) * metres) | ~all.returned(i));  // or NaN
  }
  for (std::size_t i = 0; i < all.count(); ++i) {
    const auto [sine, cosine] = direction_of(turned[i]);
    const floats x = range[i] * cosine;
    const floats y = range[i] * sine;
    const pairs first = paired<0>(x, y);
    const pairs second = paired<1>(x, y);
    store_blocks({joined<0, 0>(first, pairs{}), joined<1, 0>(first, pairs{}),
                  joined<0, 0>(second, pairs{}), joined<1, 0>(second, pairs{})},
                 out + lanes * i);
  }
  return !all.has_near();
}

template <sample_layout Layout, correction_kind Kind>
struct vector_kernels {
  using fallback = plain<Layout, Kind>;

  G4LIDAR_KERNEL_TARGET static void to_points(packet_view packet, std::uint32_t revolution,
                                              std::uint16_t shortest_mm, const packet_times& times,
                                              std::span<point, max_samples> out) noexcept {
    if (!write_points<Layout, Kind>(packet, revolution, shortest_mm, running_times(times),
                                    out.data())) {
      fallback::to_points(packet, revolution, shortest_mm, times, out);
    }
  }
  G4LIDAR_KERNEL_TARGET static void to_xy(packet_view packet, frame to, std::uint16_t turn_deg,
                                          std::span<xy_point, max_samples> out) noexcept {
    if (!write_places<Layout, Kind>(packet, to, turn_deg, out.data())) {
      fallback::to_xy(packet, to, turn_deg, out);
    }
  }
  static constexpr kernels all{to_points, to_xy};
};

}  // namespace

}  // namespace g4lidar::bulk
