// SPDX-License-Identifier: MIT
#include "pcd.hpp"

#include <string>

#include "cloud_point.hpp"
#include "value_text.hpp"

namespace g4_tool {
namespace {

void write_binary(const point& p, frame to, const model& model, text_sink& out) {
  const cloud_point shown = in_cloud(p, to, model.turn_deg);
  char* at = out.room(32);
  for (const float field : {shown.x_m, shown.y_m, 0.0F, shown.range_m, shown.angle_deg}) {
    at = put_little_endian(at, field);
  }
  at = put_little_endian(at, p.time_ns);
  if (has_intensity(model)) at = put_little_endian(at, static_cast<float>(p.intensity));
  out.wrote(at);
}

void write_ascii(const point& p, frame to, const model& model, text_sink& out) {
  const cloud_point shown = in_cloud(p, to, model.turn_deg);
  std::string line =
      shortest(shown.x_m);  // appended to: g++ 12 warns of other forms without a reason
  line.append(" ").append(shortest(shown.y_m)).append(" 0 ").append(shortest(shown.range_m));
  line.append(" ").append(shortest(shown.angle_deg)).append(" ").append(std::to_string(p.time_ns));
  if (has_intensity(model)) line.append(" ").append(std::to_string(p.intensity));
  out.write(line.append("\n"));
}

}  // namespace

void write_pcd(std::span<const point> points, frame to, pcd_data data, text_sink& out,
               const model& model) {
  const bool is_binary = data == pcd_data::binary;
  const std::string count = std::to_string(returns_in(points));
  out.write(
      "# .PCD v0.7 - Point Cloud Data file format\n"
      "VERSION 0.7\n");
  out.write(has_intensity(model) ? "FIELDS x y z range_m angle_deg time_ns intensity\n"
                                   "SIZE 4 4 4 4 4 8 4\nTYPE F F F F F I F\nCOUNT 1 1 1 1 1 1 1\n"
                                 : "FIELDS x y z range_m angle_deg time_ns\n"
                                   "SIZE 4 4 4 4 4 8\nTYPE F F F F F I\nCOUNT 1 1 1 1 1 1\n");
  out.write("WIDTH " + count +
            "\n"
            "HEIGHT 1\n"
            "VIEWPOINT 0 0 0 1 0 0 0\n"
            "POINTS " +
            count + "\n");
  out.write(is_binary ? "DATA binary\n" : "DATA ascii\n");
  for (const point& p : points) {
    if (p.is_no_return()) continue;
    is_binary ? write_binary(p, to, model, out) : write_ascii(p, to, model, out);
  }
}

}  // namespace g4_tool
