// SPDX-License-Identifier: MIT
// Flags directions without return where a target may be nearer than the shortest range.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "g4lidar/core/model.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/filter/outliers.hpp"
#include "g4lidar/point.hpp"

namespace g4lidar {

/// Which directions without return are flagged by mark_near().
struct near_limits {
  /// A nearer target gives no return, in millimetres. Returns from less than twice this are near. 0: the
  /// shortest range of the model at its sample rate. The data sheet of the G4: 280 at 9 kHz, 260 at
  /// 8 kHz, 100 at 4 kHz.
  float shortest_mm = 0.0F;
  /// For how many revolutions after the last near return a direction is flagged; until_return, 0:
  /// until a return comes from there.
  std::uint32_t revolutions = 3;

  /// A value of `revolutions`, for alarms: a target that stays too near stays flagged.
  static constexpr std::uint32_t until_return = 0;

  /// `shortest_mm`, or that of the model at `sample_rate_hz`; for a rate that it does not have that at
  /// its usual rate. *Pure.*
  [[nodiscard]] constexpr float shortest_mm_of(const model& model,
                                               std::uint32_t sample_rate_hz = 0) const noexcept {
    if (shortest_mm > 0.0F) return shortest_mm;
    const bool has_rate = code_of_rate(model, sample_rate_hz) < rate_count(model);
    return static_cast<float>(
        shortest_range_mm(model, has_rate ? sample_rate_hz : first_rate_hz(model)));
  }
};

/// From which directions near returns came last, for mark_near(). One for each lidar; 1440 bytes.
/// *Single thread, never allocates.* A copy is independent.
class near_history {
 public:
  /// The directions that it distinguishes, one degree each.
  static constexpr std::size_t directions = 360;

  /// Forgets all returns.
  constexpr void reset() noexcept { near_.fill(0); }

  /// Adds the next point in the order of measurement, which deskew() has not changed. Returns whether
  /// it has no return although a near return came from its direction, within `limits`, and none that
  /// is farther since then.
  constexpr bool add(const point& p, const near_limits& limits, const model& model = g4_model,
                     std::uint32_t sample_rate_hz = 0) noexcept {
    // The angle of the head, as a near and a far target on the same beam have different directions.
    const auto direction =
        detail::saturated<std::uint32_t>(raw_angle_deg(p, model.samples.correction));
    std::uint32_t& last = near_[direction % directions];
    if (!p.is_no_return()) {
      last =
          p.range_mm < 2.0F * limits.shortest_mm_of(model, sample_rate_hz) ? p.revolution + 1 : 0;
      return false;
    }
    if (last > p.revolution + 1) last = 0;  // of an earlier stream
    const bool is_recent = p.revolution + 1 - last <= limits.revolutions;
    return last != 0 && (is_recent || limits.revolutions == near_limits::until_return);
  }

 private:
  /// The revolution of the last near return, plus 1; 0: there is none, or a farther one came later.
  std::array<std::uint32_t, directions> near_{};
};

/// Flags as point_flags::may_be_too_near the points without return in directions where, in the last
/// `limits.revolutions` revolutions, a return came from less than twice the shortest range, and none
/// that is farther since then. Clears that flag on all other points, and returns the number of flagged
/// ones. The lidar is like `model`, and measures with `sample_rate_hz` (scan::sample_rate_hz; 0: its usual
/// rate). `points`: all points of the lidar in the order of measurement, in pieces of any size, before
/// they are filtered or deskewed; other marks do not change the result. *Never allocates.*
///
/// It finds targets that came near while the lidar saw them. It misses targets that are too near from
/// the beginning; that pass the ranges between twice and once the shortest one within a revolution;
/// that enter a direction from the side; and, unless `revolutions` is until_return, those that stay.
/// False alarms are samples without return for other reasons where something near is, or was before it
/// left a place with nothing behind it; with until_return the latter do not end. In the simulator, at
/// 9 kHz and 7 Hz, with 1 % of the samples without return for no reason, in 100 revolutions:
///
/// | what comes near | revolutions | flagged, of the samples of targets that are too near | false, of the flagged samples |
/// |---|---|---|---|
/// | a wall, to 0.15 m, which stays for 3 s | 3 | 11 % | 11 % |
/// | | until_return | 100 % | 2 % |
/// | a pole of 0.1 m, in the same way | 3 | 7 % | 5 % |
/// | | until_return | 65 % | 1 % |
/// | people, to 0.2 m, in a room | 3 | 68 % | 7 % |
/// | | until_return | 68 % | 7 % |
/// | the same where nothing is behind them | 3 | 69 % | 66 % |
/// | | until_return | 86 % | 94 % |
///
/// (tests/core/too_near_test.cpp counts them. Of a pole its edges are missed, which grow into
/// directions where the wall behind it was seen.)
constexpr std::size_t mark_near(std::span<point> points, near_history& history,
                                const near_limits& limits = {}, const model& model = g4_model,
                                std::uint32_t sample_rate_hz = 0) noexcept {
  std::size_t marked = 0;
  for (point& p : points) {
    const bool found = history.add(p, limits, model, sample_rate_hz);
    p.flags = found ? p.flags | point_flags::may_be_too_near
                    : without(p.flags, point_flags::may_be_too_near);
    marked += found ? 1U : 0U;
  }
  return marked;
}

/// The same on a copy of all `points` at the front of `out`, which is at least as long.
constexpr std::size_t mark_near(std::span<const point> points, std::span<point> out,
                                near_history& history, const near_limits& limits = {},
                                const model& model = g4_model,
                                std::uint32_t sample_rate_hz = 0) noexcept {
  return mark_near(detail::copy_points(points, out), history, limits, model, sample_rate_hz);
}

}  // namespace g4lidar
