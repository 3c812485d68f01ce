// SPDX-License-Identifier: MIT
// Points as a picture: an SVG file, seen from above.
#pragma once

#include <span>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/export/text_sink.hpp"
#include "g4lidar/point.hpp"

namespace g4lidar {

/// Writes one complete file: the returns among `points` that are not too near, in the robot's
/// frame, forward at the top, with a circle at each metre (at each 5 m if a range is above 8 m).
/// The size of the picture includes every point; one unit of the SVG is 1 cm.
G4LIDAR_API void write_svg(std::span<const point> points, text_sink& out);

}  // namespace g4lidar
