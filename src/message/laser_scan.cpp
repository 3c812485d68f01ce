// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "cdr.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/message/ros_messages.hpp"

namespace g4lidar {

std::size_t fill_time_grid(std::span<const point> points, std::int64_t duration_ns,
                           std::span<float> ranges_m, grid_options options,
                           std::span<float> intensities) noexcept {
  // The direction at the beginning, seen from each return: the corrections differ by some degrees.
  const std::int64_t begin_ns = points.empty() ? 0 : points.front().time_ns;
  const auto part_of = [&](std::int64_t time_ns) {
    return duration_ns <= 0 ? 0.0F : static_cast<float>(time_ns) / static_cast<float>(duration_ns);
  };
  std::optional<angle> first;
  float sum_deg = 0.0F;
  float count = 0.0F;
  for (const point& p : points) {
    if (p.is_no_return()) continue;
    const angle begun = angle::from_degrees(
        p.angle_deg - 360.0F * part_of(detail::saturating_sub(p.time_ns, begin_ns)));
    if (!first) first = begun;
    sum_deg += (begun - *first).signed_degrees();
    ++count;
  }
  const float begin_deg =
      first ? angle::from_degrees(first->degrees() + sum_deg / count).degrees() : 0.0F;
  const std::size_t bins = ranges_m.size();
  const std::size_t first_bin = place_in_grid(begin_deg, frame::vendor, bins).bin;
  const auto is_in_time = [&](const point& p, std::size_t bin) {
    const float part =
        static_cast<float>((bin + bins - first_bin) % bins) / static_cast<float>(bins);
    const std::int64_t since_ns = detail::saturating_sub(p.time_ns, begin_ns);
    return duration_ns <= 0 || std::abs(part - part_of(since_ns)) < 0.5F;
  };
  options.to = frame::vendor;
  fill_grid(points, ranges_m, options, is_in_time, intensities);
  return first_bin;
}

void fill_laser_scan(const scan& source, message_header& header, std::size_t bins,
                     const grid_options& options, std::vector<float>& ranges_m,
                     std::vector<float>& intensities) {
  ranges_m.resize(bins);
  intensities.resize(has_intensity(*source.model) ? bins : 0);
  grid_options how = options.with(*source.model);
  header.longest_mm = how.longest_mm;
  how.to = frame::robot;
  header.first_bin = 0;
  if (header.order == scan_order::time) {
    header.first_bin =
        fill_time_grid(source.points, source.duration_ns, ranges_m, how, intensities);
  } else {
    fill_grid(source.points, ranges_m, how, intensities);
  }
  header.intensities = intensities;
}

laser_scan_numbers numbers_of(const message_header& header, std::size_t bins) noexcept {
  bins = std::max<std::size_t>(bins, 1);
  constexpr float pi = std::numbers::pi_v<float>;
  const bool is_by_time = header.order == scan_order::time;
  const std::size_t first = is_by_time ? header.first_bin % bins : 0;
  const float increment = 2 * pi / static_cast<float>(bins);
  // Of bin 0: by angle it is behind; by time it is 0 degrees of the device, mirrored like the frame.
  const float begin = is_by_time && header.model->turn_deg == 0 ? 0.0F : -pi;
  const float from_begin = begin + increment * static_cast<float>(first);
  const float least = from_begin < pi ? from_begin : from_begin - 2 * pi;
  const float longest_mm =
      header.longest_mm > 0.0F ? header.longest_mm : static_cast<float>(header.model->range.max_mm);
  const float duration_s = static_cast<float>(header.duration_ns) * 1e-9F;
  return {.angle_min_rad = least,
          .angle_max_rad = least + increment * static_cast<float>(bins - 1),
          .angle_increment_rad = increment,
          .time_increment_s = is_by_time ? duration_s / static_cast<float>(bins) : 0.0F,
          .scan_time_s = duration_s,
          .range_min_m = static_cast<float>(header.model->range.min_mm) * 0.001F,
          .range_max_m = longest_mm * 0.001F,
          .first = first};
}

void put_laser_scan(std::span<const float> ranges_m, const message_header& header,
                    std::vector<std::uint8_t>& out) {
  const laser_scan_numbers numbers = numbers_of(header, ranges_m.size());
  cdr_writer message(out);
  put_header(message, header.stamp_ns, header.frame_id);
  message.put(numbers.angle_min_rad);
  message.put(numbers.angle_max_rad);
  message.put(numbers.angle_increment_rad);
  message.put(numbers.time_increment_s);
  message.put(numbers.scan_time_s);
  message.put(numbers.range_min_m);
  message.put(numbers.range_max_m);
  for (const std::span<const float> values : {ranges_m, header.intensities}) {
    message.put(static_cast<std::uint32_t>(values.size()));
    const std::size_t from = std::min(numbers.first, values.size());
    for (const float value : values.subspan(from)) message.put(value);
    for (const float value : values.first(from)) message.put(value);
  }
}

}  // namespace g4lidar
