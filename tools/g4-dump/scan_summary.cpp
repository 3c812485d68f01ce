// SPDX-License-Identifier: MIT
// Counts over a revolution, and the names of the reasons why it is partial.
#include "scan_summary.hpp"

#include <array>
#include <utility>

namespace g4_dump {

scan_summary summary_of(const shown_scan& shown, const point_style& style) {
  scan_summary result;
  for (const g4lidar::point& p : shown.scan.points) {
    if (style.leaves_out(p)) continue;
    ++result.points;
    if (!p.is_no_return()) ++result.returns;
  }
  result.reported_hz = shown.scan.reported_frequency_dhz / 10.0;
  return result;
}

shown_scan counted_scan(const g4lidar::scan& scan, std::uint32_t rate_hz) {
  shown_scan result{.scan = scan};
  if (!scan.points.empty()) result.time_ns = scan.points.front().time_ns;
  // After a loss, times that are counted are early.
  g4lidar::scan untimed = scan;
  untimed.duration_ns = 0;
  result.measured_hz = static_cast<double>(untimed.measured_frequency_hz(rate_hz));
  return result;
}

std::string names_of(g4lidar::scan_marks marks, std::string_view before, std::string_view between,
                     std::string_view after) {
  using enum g4lidar::scan_marks;
  constexpr std::array<std::pair<g4lidar::scan_marks, std::string_view>, 4> names{
      {{start_missing, "start_missing"},
       {end_missing, "end_missing"},
       {data_lost, "data_lost"},
       {turn_short, "turn_short"}}};
  std::string text;
  for (const auto& [mark, name] : names) {
    if ((marks & mark) == none) continue;
    if (!text.empty()) text += between;
    text.append(before).append(name).append(after);
  }
  return text;
}

}  // namespace g4_dump
