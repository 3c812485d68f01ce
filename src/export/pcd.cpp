// SPDX-License-Identifier: MIT
#include "g4lidar/export/pcd.hpp"

#include <bit>
#include <string>

#include "g4lidar/core/angle.hpp"
#include "value_text.hpp"

namespace g4lidar {
namespace {

/// A point of the cloud, with the layout of a binary file, except for the byte order.
struct cloud_point {
  float x_m;
  float y_m;
  float range_m;
  float angle_deg;
  std::int64_t time_ns;
};

cloud_point in_cloud(const point& p, frame to) noexcept {
  const float degrees = bearing_deg(p.angle_deg, to);
  const sine_cosine direction = sine_cosine_deg(degrees);
  const float range_m = p.range_mm / 1000.0F;
  const bool is_signed = to == frame::robot && degrees >= 180.0F;
  return {range_m * direction.cosine, range_m * direction.sine, range_m,
          is_signed ? degrees - 360.0F : degrees, p.time_ns};
}

void write_binary(const cloud_point& p, text_sink& out) {
  char* at = out.room(sizeof(cloud_point) + sizeof(float));
  for (const float field : {p.x_m, p.y_m, 0.0F, p.range_m, p.angle_deg}) {
    digits::put_word(at,
                     std::bit_cast<std::uint32_t>(field));  // the next field overwrites half of it
    at += sizeof field;
  }
  digits::put_word(at, static_cast<std::uint64_t>(p.time_ns));
  out.wrote(at + sizeof p.time_ns);
}

void write_ascii(const cloud_point& p, text_sink& out) {
  out.write(shortest(p.x_m) + " " + shortest(p.y_m) + " 0 " + shortest(p.range_m) + " " +
            shortest(p.angle_deg) + " " + std::to_string(p.time_ns) + "\n");
}

}  // namespace

void write_pcd(std::span<const point> points, frame to, pcd_data data, text_sink& out) {
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
    const cloud_point shown = in_cloud(p, to);
    is_binary ? write_binary(shown, out) : write_ascii(shown, out);
  }
}

}  // namespace g4lidar
