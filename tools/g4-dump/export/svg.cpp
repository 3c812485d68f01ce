// SPDX-License-Identifier: MIT
#include "svg.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "g4lidar/cartesian.hpp"

namespace g4_tool {
namespace {

/// Beyond this range, in millimetres, the circles are 5 m apart.
constexpr float far_mm = 8000.0F;

bool is_drawn(const point& p) noexcept {
  return !p.is_no_return() && !p.is_too_near() && p.range_mm >= 0.0F && p.range_mm < 1e8F;
}

std::string centimetres(float metres) { return std::to_string(std::lround(metres * 100.0F)); }

/// An element <circle> around the lidar.
std::string circle(int radius_cm) { return "<circle r=\"" + std::to_string(radius_cm) + "\"/>\n"; }

}  // namespace

void write_svg(std::span<const point> points, text_sink& out, std::uint16_t turn_deg) {
  float furthest_mm = 1000.0F;
  for (const point& p : points) {
    if (is_drawn(p)) furthest_mm = std::max(furthest_mm, p.range_mm);
  }
  const int step_cm = furthest_mm > far_mm ? 500 : 100;
  const int reach_cm = static_cast<int>(furthest_mm / 10.0F) + 20;
  const std::string side = std::to_string(2 * reach_cm);
  const std::string corner = std::to_string(-reach_cm);
  const std::string dot = std::to_string(std::max(3, reach_cm / 120));
  out.write("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"640\" height=\"640\" viewBox=\"" +
            corner + " " + corner + " " + side + " " + side + "\">\n");
  out.write("<rect x=\"" + corner + "\" y=\"" + corner + "\" width=\"" + side + "\" height=\"" +
            side + "\" fill=\"#ffffff\"/>\n<g fill=\"none\" stroke=\"#c8d0d8\" stroke-width=\"" +
            std::to_string(std::max(1, reach_cm / 400)) + "\">\n");
  for (int radius_cm = step_cm; radius_cm < reach_cm; radius_cm += step_cm) {
    out.write(circle(radius_cm));
  }
  // The lidar: an arrow that points forward.
  const std::string size = std::to_string(std::max(8, reach_cm / 40));
  out.write("</g>\n<path d=\"M0-" + size + "L" + size + " " + size + "H-" + size +
            "Z\" fill=\"#d04030\"/>\n<path d=\"");
  for (const point& p : points) {
    if (!is_drawn(p)) continue;
    const xy_point place =
        to_xy(p, frame::robot, turn_deg);  // x forward is up, y to the left is left
    out.write("M");
    out.write(centimetres(-place.y_m) + " " + centimetres(-place.x_m) + "h0");
  }
  out.write("\" stroke=\"#0b62a8\" stroke-linecap=\"round\" stroke-width=\"" + dot +
            "\"/>\n</svg>\n");
}

}  // namespace g4_tool
