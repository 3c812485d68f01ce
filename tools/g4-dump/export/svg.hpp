// SPDX-License-Identifier: MIT
// Points as a picture: an SVG file, seen from above.
#pragma once

#include <cstdint>
#include <span>

#include "g4lidar/point.hpp"
#include "g4lidar/scan.hpp"
#include "io/text_sink.hpp"

namespace g4_tool {

using namespace g4lidar;

/// Writes one complete file: the returns among `points` that are not too near, in the robot's
/// frame, forward at the top, with a circle at each metre (at each 5 m if a range is above 8 m).
/// The size of the picture includes every point; one unit of the SVG is 1 cm. `turn_deg` is that of
/// the model, 0 or 180.
void write_svg(std::span<const point> points, text_sink& out,
               std::uint16_t turn_deg = g4_model.turn_deg);
/// The same for the points of a scan, turned as its model.
inline void write_svg(const scan& source, text_sink& out) {
  write_svg(source.points, out, source.model->turn_deg);
}

}  // namespace g4_tool
