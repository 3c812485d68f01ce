// SPDX-License-Identifier: MIT
#include "g4lidar/export/pcd.hpp"

#include <bit>
#include <string>

#include "cloud_point.hpp"
#include "value_text.hpp"

namespace g4lidar {
namespace {

/// 28 bytes.
void write_binary(const point& p, frame to, std::uint16_t turn_deg, text_sink& out) {
  const cloud_point shown = in_cloud(p, to, turn_deg);
  char* at = out.room(28);
  for (const float field : {shown.x_m, shown.y_m, 0.0F, shown.range_m, shown.angle_deg}) {
    digits::put_word(at,
                     std::bit_cast<std::uint32_t>(field));  // the next field overwrites half of it
    at += sizeof field;
  }
  digits::put_word(at, static_cast<std::uint64_t>(p.time_ns));
  out.wrote(at + sizeof p.time_ns);
}

void write_ascii(const point& p, frame to, std::uint16_t turn_deg, text_sink& out) {
  const cloud_point shown = in_cloud(p, to, turn_deg);
  out.write(shortest(shown.x_m) + " " + shortest(shown.y_m) + " 0 " + shortest(shown.range_m) +
            " " + shortest(shown.angle_deg) + " " + std::to_string(p.time_ns) + "\n");
}

}  // namespace

void write_pcd(std::span<const point> points, frame to, pcd_data data, text_sink& out,
               std::uint16_t turn_deg) {
  const bool is_binary = data == pcd_data::binary;
  const std::string count = std::to_string(returns_in(points));
  out.write(
      "# .PCD v0.7 - Point Cloud Data file format\n"
      "VERSION 0.7\n"
      "FIELDS x y z range_m angle_deg time_ns\n"
      "SIZE 4 4 4 4 4 8\n"
      "TYPE F F F F F I\n"
      "COUNT 1 1 1 1 1 1\n"
      "WIDTH " +
      count +
      "\n"
      "HEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\n"
      "POINTS " +
      count + "\n");
  out.write(is_binary ? "DATA binary\n" : "DATA ascii\n");
  for (const point& p : points) {
    if (p.is_no_return()) continue;
    is_binary ? write_binary(p, to, turn_deg, out) : write_ascii(p, to, turn_deg, out);
  }
}

}  // namespace g4lidar
