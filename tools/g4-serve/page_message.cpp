// SPDX-License-Identifier: MIT
#include "page_protocol.hpp"

#include <bit>
#include <cstddef>

#include "g4lidar/cartesian.hpp"

namespace g4_tool {
namespace {

template <class Unsigned>
void put_little(Unsigned value, std::vector<std::uint8_t>& out) {
  for (std::size_t i = 0; i < sizeof(value); ++i) {
    out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
}

}  // namespace

void put_page_scan(const page_scan& what, std::vector<std::uint8_t>& out) {
  constexpr unsigned has_place = 2;
  constexpr unsigned has_lidars = 4;
  constexpr unsigned has_intensities = 8;
  const scan& revolution = what.revolution;
  const bool has_intensity = g4lidar::has_intensity(*revolution.model);
  const std::size_t begin = out.size();
  out.push_back(0x10);
  out.push_back(static_cast<std::uint8_t>(
      (revolution.is_whole() ? 1U : 0U) | (what.place ? has_place : 0U) |
      (what.points_of_each.empty() ? 0U : has_lidars) | (has_intensity ? has_intensities : 0U)));
  put_little(std::uint16_t{0}, out);
  put_little(revolution.revolution, out);
  put_little(std::bit_cast<std::uint64_t>(what.stamp_s), out);
  std::uint16_t count = 0;
  std::vector<std::uint16_t> intensities;
  /// The returns of so many points more.
  const auto put_returns = [&](std::span<const point> points) {
    for (const point& p : points) {
      if (p.is_no_return() || count == UINT16_MAX) continue;
      const xy_point at = to_xy(p, frame::robot, revolution.model->turn_deg);
      put_little(std::bit_cast<std::uint32_t>(at.x_m), out);
      put_little(std::bit_cast<std::uint32_t>(what.is_upside_down ? -at.y_m : at.y_m), out);
      if (has_intensity) intensities.push_back(p.intensity);
      ++count;
    }
  };
  std::vector<std::uint16_t> returns_of_each;
  std::size_t from = 0;
  for (const std::size_t points : what.points_of_each) {
    const std::uint16_t before = count;
    put_returns(revolution.points.subspan(from, points));
    returns_of_each.push_back(static_cast<std::uint16_t>(count - before));
    from += points;
  }
  put_returns(revolution.points.subspan(from));
  out[begin + 2] = static_cast<std::uint8_t>(count);
  out[begin + 3] = static_cast<std::uint8_t>(count >> 8U);
  if (what.place) {
    put_little(what.place->map, out);
    for (const double value :
         {what.place->pose.x_m, what.place->pose.y_m, what.place->pose.yaw_rad})
      put_little(std::bit_cast<std::uint64_t>(value), out);
  }
  if (!returns_of_each.empty()) {
    put_little(static_cast<std::uint16_t>(returns_of_each.size()), out);
    for (const std::uint16_t returns : returns_of_each) put_little(returns, out);
  }
  for (const std::uint16_t each : intensities) put_little(each, out);
}

}  // namespace g4_tool
