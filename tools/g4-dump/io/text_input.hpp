// SPDX-License-Identifier: MIT
// Points as text, which are converted to another form.
#pragma once

#include "export/text_points.hpp"
#include "point_output.hpp"

namespace g4_tool {

/// Points in `form`, with angles in frame `in`, to the output: not of a lidar, which only its owner can name. Returns the
/// exit code; throws a failure or a bad_value.
[[nodiscard]] int convert_text(const point_options& options, text_source form, g4lidar::frame in);

}  // namespace g4_tool
