// SPDX-License-Identifier: MIT
// Points as text: which columns they have, and what is reported of them.
#pragma once

#include <string>

#include "cli/common_options.hpp"
#include "export/text_points.hpp"
#include "g4lidar/core/model.hpp"
#include "io/input.hpp"

namespace g4_tool {

/// The model of the points in `in`: the one that `common` names, else a G4; with samples of another layout
/// if the first line shows that the points have an intensity or flags that those of the model do not
/// have. Reads ahead. Reports where no model is named and the G4 has to be taken for another lidar.
[[nodiscard]] g4lidar::model model_of_text(input& in, text_source form,
                                           const common_options& common);

/// Reports the counts of the text `title`, whose points are those of a lidar like `which`. Throws a failure if it has
/// no points, or values in later lines that the first one does not announce.
void report_text(const text_points& text, const std::string& title, const g4lidar::model& which);

}  // namespace g4_tool
