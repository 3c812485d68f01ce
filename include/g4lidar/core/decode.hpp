// SPDX-License-Identifier: MIT
// From a packet to corrected points in the caller's memory.
#pragma once

#include <array>
#include <cassert>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "g4lidar/core/angle.hpp"
#include "g4lidar/core/correction.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/point.hpp"

namespace g4lidar {

/// Numbers the revolutions of a stream: 0 at its beginning, and one more with each zero packet
/// except the very first packet. *Single thread.*
class revolution_counter {
 public:
  /// The revolution of `packet`. Call it once for every packet, also for suspect ones.
  constexpr std::uint32_t count(packet_view packet) noexcept {
    if (packet.is_zero() && !first_) ++revolution_;
    first_ = false;
    return revolution_;
  }

 private:
  std::uint32_t revolution_ = 0;
  bool first_ = true;
};

/// The points of one packet, and its properties. `points` is in the memory that was given to
/// decode().
struct decoded {
  std::span<const point> points;        ///< Empty if the packet is suspect.
  std::uint32_t revolution = 0;         ///< As given to decode().
  std::uint16_t sample_count = 0;       ///< Of the packet, suspect or not.
  std::uint16_t first_angle_64ths = 0;  ///< First-level angle of the first sample, 1/64 degree.
  std::int16_t span_64ths = 0;          ///< Clockwise turn to the last sample, 1/64 degree.
  std::uint16_t reported_frequency_chz = 0;  ///< 0.01 Hz; 0 if none is reported.
  bool starts_revolution = false;            ///< A zero packet, suspect or not.
  bool suspect = false;                      ///< The angles of its samples are not known.
};

/// How the word of a range is read. *Pure*, and without a branch.
template <sample_layout Layout>
struct range_word {
  /// Whether its lower two bits are not part of the range.
  static constexpr bool has_low_bits = Layout == sample_layout::flagged_mm ||
                                       Layout == sample_layout::intensity_8 ||
                                       Layout == sample_layout::intensity_10;
  /// The unit of the word, in quarters of a millimetre.
  static constexpr std::int32_t unit = Layout == sample_layout::half_mm        ? 2
                                       : Layout == sample_layout::whole_mm     ? 4
                                       : Layout == sample_layout::intensity_16 ? 4
                                                                               : 1;
  /// The least range, in quarters of a millimetre. Less is no return.
  static constexpr std::int32_t least = unit == 1 ? std::int32_t{least_range_raw} : unit;

  /// In quarters of a millimetre; below `least` for no return.
  [[nodiscard]] static constexpr std::int32_t quarters(std::uint16_t raw) noexcept {
    return has_low_bits ? raw & 0xFFFC : raw * unit;
  }
  /// The correction of its range.
  template <correction_form Form>
  [[nodiscard]] static constexpr auto correction(const Form& form, std::uint16_t raw) noexcept {
    if constexpr (requires { form(quarters(raw), least); } && least != least_range_raw) {
      return form(quarters(raw), least);
    } else if constexpr (unit == 1 && !has_low_bits) {
      return form(raw);
    } else {
      return form(quarters(raw));
    }
  }
};

/// The flags of a sample that follow from its range; below `shortest_mm` it is too near. *Pure*, and
/// without a branch.
template <sample_layout Layout = g4_layout>
[[nodiscard]] constexpr point_flags flag_of(
    std::uint16_t raw, std::uint16_t shortest_mm = g4_model.range.min_mm) noexcept {
  static_assert(static_cast<int>(point_flags::too_near) - 1 ==
                static_cast<int>(point_flags::no_return));
  using word = range_word<Layout>;
  const int near = word::quarters(raw) < 4 * shortest_mm;
  const int no_return = word::quarters(raw) < word::least;
  return static_cast<point_flags>(2 * near - no_return);
}

/// The range of a sample in millimetres, 0 for no return. *Pure*, and without a branch.
template <sample_layout Layout = g4_layout>
[[nodiscard]] constexpr float range_mm_of(std::uint16_t raw) noexcept {
  using word = range_word<Layout>;
  const std::int32_t whole = word::quarters(raw);
  return static_cast<float>(whole < word::least ? 0 : whole) * 0.25F;
}

/// The flags that a sample contains, by the word of its range. *Pure.*
template <sample_layout Layout>
[[nodiscard]] constexpr std::uint8_t sample_flags_of(std::uint16_t raw) noexcept {
  return static_cast<std::uint8_t>(has_sample_flags(Layout) ? raw & 3U : 0U);
}

/// The intensity of a sample, by what is before the word of its range, and that word. *Pure.*
template <sample_layout Layout>
[[nodiscard]] constexpr std::uint16_t intensity_of(std::uint16_t before,
                                                   std::uint16_t raw) noexcept {
  constexpr bool has_upper_bits = Layout == sample_layout::intensity_10;
  return static_cast<std::uint16_t>(before | (has_upper_bits ? (raw & 3U) << 8 : 0U));
}

/// The first-level angles of a packet that is not suspect, in degrees: sample `i` is at `first` +
/// `i` * `step`. If the packet passes zero, the first angle is negative, so that no angle is 360 or
/// more: there, single precision has only half the resolution.
template <std::floating_point Real>
struct first_level_angles {
  Real first;
  Real step;

  /// The angles of `packet`.
  explicit constexpr first_level_angles(packet_view packet) noexcept {
    const int begin = packet.first_angle_64ths();
    const int way = packet.span_64ths();
    const int gaps = static_cast<int>(packet.sample_count()) - 1;
    first = static_cast<Real>(begin + way >= turn_64ths ? begin - turn_64ths : begin) / Real(64);
    step = gaps > 0 ? static_cast<Real>(way) / static_cast<Real>(64 * gaps) : Real(0);
  }
};

/// The properties of `packet` without its points. *Pure.*
[[nodiscard]] constexpr decoded without_points(packet_view packet,
                                               std::uint32_t revolution) noexcept {
  decoded result;
  result.revolution = revolution;
  result.sample_count = static_cast<std::uint16_t>(packet.sample_count());
  result.first_angle_64ths = static_cast<std::uint16_t>(packet.first_angle_64ths());
  result.span_64ths = static_cast<std::int16_t>(packet.span_64ths());
  if (packet.is_zero()) {  // once a revolution
    result.reported_frequency_chz = static_cast<std::uint16_t>(packet.reported_frequency_chz());
  }
  result.starts_revolution = packet.is_zero();
  result.suspect = packet.is_suspect();
  return result;
}

/// Writes the corrected points of `packet` to the front of `out`, which has room for the longest
/// packet, and returns them with the properties of the packet. *Pure, never allocates.* A suspect
/// packet gives no points. Times are 0, not known. Returns below `shortest_mm` are too near. A packet
/// of another layout is an assertion. (protocol: Point packets)
template <sample_layout Layout = g4_layout, correction_form Form>
constexpr decoded decode(packet_view packet, const Form& correction, std::uint32_t revolution,
                         std::span<point, max_samples> out,
                         std::uint16_t shortest_mm = g4_model.range.min_mm) noexcept {
  using real = decltype(correction(std::uint16_t{}));
  assert(packet.layout() == Layout);
  decoded result = without_points(packet, revolution);
  if (result.suspect) return result;

  const std::size_t count = packet.sample_count();
  const first_level_angles<real> angles(packet);
  // First all directions, sixteen at a time: compilers vectorize a loop with a constant number of
  // rounds and no branch. Behind the last sample the copy holds zeros.
  constexpr std::int32_t at_once = 16;
  std::array<std::uint16_t, max_samples> raw;
  std::array<real, max_samples> angles_deg;
  packet.copy_samples(raw);
  for (std::size_t from = 0; from < count; from += at_once) {
    const std::uint16_t* const raw_here = raw.data() + from;
    real* const angles_here = angles_deg.data() + from;
    const auto place = static_cast<std::int32_t>(from);
    for (std::int32_t i = 0; i < at_once; ++i) {
      const real turned = static_cast<real>(place + i) * angles.step +
                          range_word<Layout>::correction(correction, raw_here[i]);
      angles_here[i] = wrap_once_deg(angles.first + turned);
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    auto angle_deg = static_cast<float>(angles_deg[i]);
    if constexpr (sizeof(real) > sizeof(float)) angle_deg = wrap_once_deg(angle_deg);
    const std::uint16_t before = sample_size(Layout) == 2 ? 0 : packet.intensity_word(i);
    out[i] = {angle_deg,
              range_mm_of<Layout>(raw[i]),
              0,
              revolution,
              flag_of<Layout>(raw[i], shortest_mm),
              sample_flags_of<Layout>(raw[i]),
              intensity_of<Layout>(before, raw[i])};
  }
  if (result.starts_revolution) out[0].flags = out[0].flags | point_flags::revolution_start;
  result.points = out.first(count);
  return result;
}

}  // namespace g4lidar
