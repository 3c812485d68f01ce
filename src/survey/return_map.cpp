// SPDX-License-Identifier: MIT
#include "return_map.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "g4lidar/core/correction.hpp"
#include "g4lidar/core/decode.hpp"

namespace g4lidar {
namespace {

/// From here on the correction of a triangle is within 1.3 degrees of its limit; that of an SCL is below 1.1.
constexpr std::int32_t far_quarters = 4 * 1000;

double correction_deg(std::int32_t quarters, correction_kind kind) noexcept {
  if (kind == correction_kind::triangle) return exact_correction{}(quarters);
  return kind == correction_kind::scl ? static_cast<double>(scl_correction{}(quarters)) : 0.0;
}

}  // namespace

/// Counts each degree from the one with `from_deg` to the one with `to_deg`.
void return_map::mark(degree_counts& counts, double from_deg, double to_deg) noexcept {
  const int from = static_cast<int>(std::floor(from_deg));
  const int to = std::min(static_cast<int>(std::floor(to_deg)), from + full_turn_deg - 1);
  for (int degree = from; degree <= to; ++degree) {
    ++counts[static_cast<std::size_t>((degree % full_turn_deg + full_turn_deg) % full_turn_deg)];
  }
}

void return_map::take(packet_view packet, const sample_format& format) noexcept {
  if (packet.is_suspect()) return;
  if (packet.is_zero()) {
    ++revolutions_;
    is_looking_ = !is_thinned_ || revolutions_ == 1 || revolutions_ % 64 == 0;
  }
  if (!is_looking_) return;
  switch (format.layout) {
    case sample_layout::quarter_mm:
      return take_as<sample_layout::quarter_mm>(packet, format.correction);
    case sample_layout::half_mm:
      return take_as<sample_layout::half_mm>(packet, format.correction);
    case sample_layout::whole_mm:
    case sample_layout::intensity_16:
      return take_as<sample_layout::whole_mm>(packet, format.correction);
    case sample_layout::flagged_mm:
    case sample_layout::intensity_10:
    case sample_layout::intensity_8:
      return take_as<sample_layout::flagged_mm>(packet, format.correction);
  }
}

/// With ranges as of this layout.
template <sample_layout Ranges>
void return_map::take_as(packet_view packet, correction_kind kind) noexcept {
  using word = range_word<Ranges>;
  const first_level_angles<double> angles(packet);
  const std::size_t count = packet.sample_count();
  const auto angle_of = [&](std::size_t i) {
    return angles.first + static_cast<double>(i) * angles.step;
  };
  const double limit_deg = no_return_correction_deg(kind);
  const double nearest_deg = correction_deg(far_quarters, kind);
  mark(looks_, angle_of(0) + limit_deg, angle_of(count - 1) + limit_deg);
  samples_ += count;
  std::size_t far = 0;  // returns of far targets one behind the other
  const auto end_far = [&](std::size_t end) {
    if (far == 0) return;
    const double from_deg = angle_of(end - far) + std::min(limit_deg, nearest_deg);
    mark(returned_, from_deg - 1.0, angle_of(end - 1) + std::max(limit_deg, nearest_deg) + 1.0);
    returns_ += std::exchange(far, 0);
  };
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t quarters = word::quarters(packet.sample(i));
    if (quarters >= far_quarters) {
      ++far;
      continue;
    }
    end_far(i);
    if (quarters < word::least) continue;
    ++returns_;
    const double near_deg = angle_of(i) + correction_deg(quarters, kind);
    mark(returned_, near_deg - 1.0, near_deg + 1.0);
  }
  end_far(count);
}

void return_map::add(const return_map& other) noexcept {
  std::ranges::transform(looks_, other.looks_, looks_.begin(), std::plus<>());
  std::ranges::transform(returned_, other.returned_, returned_.begin(), std::plus<>());
  samples_ += other.samples_;
  returns_ += other.returns_;
}

bool return_map::is_round() const noexcept {
  return std::ranges::all_of(looks_, [](std::uint32_t looks) { return looks > 0; });
}

std::vector<direction_arc> return_map::arcs_of(const std::array<bool, full_turn_deg>& is_silent,
                                               int least_deg) {
  const auto* const first = std::ranges::find(is_silent, false);
  if (first == is_silent.end()) return {{0, full_turn_deg}};
  const int begin = static_cast<int>(first - is_silent.begin());
  const auto is_silent_at = [&](int degree) {
    return is_silent[static_cast<std::size_t>(degree % full_turn_deg)];
  };
  std::vector<direction_arc> found;
  for (int degree = begin; degree < begin + full_turn_deg;) {
    int end = degree;
    while (is_silent_at(end)) ++end;
    if (end - degree >= least_deg) found.push_back({degree % full_turn_deg, end - degree});
    degree = end + 1;
  }
  return found;
}

}  // namespace g4lidar
