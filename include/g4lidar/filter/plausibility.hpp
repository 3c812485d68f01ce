// SPDX-License-Identifier: MIT
// What the checksum does not find: packets whose angles do not fit, samples with one wrong bit.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "g4lidar/core/packet.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/point.hpp"

namespace g4lidar {

/// Judges the angles of packets by those before them: the first angle follows the last one of the
/// packet before, and the turn of a packet is that of its samples, at the speed of the motor. A G4
/// changes its speed slowly. It marks, and decides nothing: a wrong packet that it does not find
/// still has a place in its revolution. *Single thread, never allocates.*
class angle_check {
 public:
  /// Whether the angles of `packet` fit. Call it once for each packet, in order. The first packets
  /// are not judged, until the speed is known. A packet that does not fit is left aside; if the next
  /// one does not fit either, the angle and the speed are taken anew: the head may have been stopped,
  /// or packets are missing of which nobody knows.
  [[nodiscard]] constexpr bool fits(packet_view packet) noexcept {
    const int gaps = static_cast<int>(packet.sample_count()) - 1;
    const int first = packet.first_angle_64ths();
    const int span = packet.span_64ths();
    if (packet.is_suspect()) return pass_by(gaps + 1);
    const bool has_fit = fits_turn(span, gaps) && (!follows_ || fits_at(first));
    if (!has_fit && !missed_) {
      missed_ = true;
      return pass_by(gaps + 1);
    }
    if (!has_fit) has_speed_ = false;
    missed_ = false;
    take(first, span, gaps);
    return has_fit;
  }

  /// Bytes between the packets before and after were lost: of the next packet only the turn is judged.
  constexpr void lost() noexcept { follows_ = false; }

 private:
  // Angles are rounded to 1/64 degree at both ends of a packet.
  static constexpr float rounding_64ths = 2.5F;
  // Samples that may be missing between two packets: real devices left out up to four while the motor
  // gained speed.
  static constexpr float most_missing = 5.0F;
  // How much a turn may differ from that at the speed of the packets before, as a part of it.
  static constexpr float part = 0.1F;

  constexpr bool pass_by(int samples) noexcept {
    goes_on_at(next_64ths_ + static_cast<float>(samples) * step_64ths_);
    return false;
  }
  constexpr void goes_on_at(float angle_64ths) noexcept {
    while (angle_64ths >= turn_64ths) angle_64ths -= turn_64ths;
    next_64ths_ = angle_64ths;
  }
  [[nodiscard]] constexpr bool fits_at(int first) const noexcept {
    if (!has_speed_) return true;
    float off = static_cast<float>(first) - next_64ths_;
    constexpr float half_turn_64ths = turn_64ths * 0.5F;
    if (off > half_turn_64ths) off -= turn_64ths;
    if (off < -half_turn_64ths) off += turn_64ths;
    return off <= rounding_64ths + most_missing * step_64ths_ &&
           off >= -rounding_64ths - step_64ths_;
  }
  [[nodiscard]] constexpr bool fits_turn(int span, int gaps) const noexcept {
    if (!has_speed_ || gaps == 0) return true;
    const float turn = static_cast<float>(gaps) * step_64ths_;
    const float off = static_cast<float>(span) - turn;
    const float most = rounding_64ths + part * turn;
    return off <= most && off >= -most;
  }
  constexpr void take(int first, int span, int gaps) noexcept {
    if (gaps >= 8) {
      const float step = static_cast<float>(span) / static_cast<float>(gaps);
      step_64ths_ = has_speed_ ? step_64ths_ + 0.25F * (step - step_64ths_) : step;
      has_speed_ = true;
    }
    goes_on_at(static_cast<float>(first + span) + step_64ths_);
    follows_ = true;
  }

  float next_64ths_ = 0.0F;  // where the next packet begins
  float step_64ths_ = 0.0F;  // between two samples
  bool follows_ = false;
  bool has_speed_ = false;
  bool missed_ = false;
};

/// How smooth the neighbours of a sample must be, and how far it must be from them.
struct bit_error_limits {
  /// Neighbours are smooth if they differ by at most this many millimetres, or this part of the range.
  float smooth_mm = 20.0F;
  float smooth_ratio = 0.02F;
};

namespace detail {

/// Whether `raw` is off the middle of smooth neighbours by one bit of its 16; `far` and `far_on` are
/// the samples two before and two after it. All have 16 bits.
[[nodiscard]] constexpr bool has_one_wrong_bit(std::int32_t far, std::int32_t before,
                                               std::int32_t raw, std::int32_t after,
                                               std::int32_t far_on, const bit_error_limits& limits,
                                               int units_per_mm) noexcept {
  const auto magnitude = [](std::int32_t x) { return x < 0 ? -x : x; };
  if (raw == 0) return false;
  // Where nothing comes back, a return of one bit.
  if (before == 0 && after == 0) return (raw & (raw - 1)) == 0;
  if (before == 0 || after == 0 || far == 0 || far_on == 0) return false;
  const std::int32_t middle = (before + after) / 2;
  const auto ratio = saturated<std::uint16_t>(limits.smooth_ratio * static_cast<float>(middle));
  const auto least = saturated<std::uint16_t>(static_cast<float>(units_per_mm) * limits.smooth_mm);
  const std::int32_t smooth = ratio > least ? ratio : least;
  if (magnitude(before - after) > 2 * smooth || magnitude(far - before) > smooth ||
      magnitude(far_on - after) > smooth) {
    return false;
  }
  const std::int32_t off = magnitude(raw - middle);
  for (std::int32_t bit = 1 << 15; bit > 3 * smooth; bit >>= 1) {
    const bool is_set = (raw & bit) != 0;
    if (magnitude(off - bit) <= smooth && is_set == (raw > middle)) return true;
  }
  return false;
}

}  // namespace detail

/// Flags the returns that differ in one bit of the raw sample from the smooth surface of two
/// neighbours on each side as point_flags::unlikely; no flag is cleared. Returns how many were
/// flagged. The first two and last two points are not judged. *Pure, never allocates*, linear. The
/// points are those of decode(), in the order of measurement. A thin object whose distance to the
/// surface behind it is by chance a power of two of the unit of the samples is flagged, too: so such
/// points are marked, and never left out by themselves. `layout` is that of the samples.
constexpr std::size_t mark_bit_errors(std::span<point> points, const bit_error_limits& limits = {},
                                      sample_layout layout = g4_layout) noexcept {
  const int units = range_units_per_mm(layout);
  const auto raw = [&points, units](std::size_t i) {
    return std::int32_t{
        detail::saturated<std::uint16_t>(points[i].range_mm * static_cast<float>(units))};
  };
  if (points.size() < 5) return 0;
  std::size_t marked = 0;
  std::array<std::int32_t, 5> near{0, raw(0), raw(1), raw(2), raw(3)};  // of the samples around `i`
  for (std::size_t i = 2; i + 2 < points.size(); ++i) {
    near = {near[1], near[2], near[3], near[4], raw(i + 2)};
    if (!detail::has_one_wrong_bit(near[0], near[1], near[2], near[3], near[4], limits, units)) {
      continue;
    }
    points[i].flags = points[i].flags | point_flags::unlikely;
    ++marked;
  }
  return marked;
}

/// Flags all returns of a packet as point_flags::unlikely, for angle_check.
constexpr void mark_unlikely(std::span<point> points) noexcept {
  for (point& p : points) p.flags = p.flags | point_flags::unlikely;
}

}  // namespace g4lidar
