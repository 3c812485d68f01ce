// SPDX-License-Identifier: MIT
// The parameters of a lidar by the options of the program.
#pragma once

#include <map>
#include <string>

#include "cli/common_options.hpp"
#include "g4lidar/lidar_parameters.hpp"
#include "g4lidar/scan_shaper.hpp"

namespace g4_tool {

/// `how`: the filters at the start; `words`: some of them as text. `shaper` shapes by them, for messages of this
/// lidar or for merging, and outlives the parameters. Throws a failure for a mask that cannot be read.
[[nodiscard]] lidar_parameters parameters_of(const common_options& how,
                                             const std::map<std::string, std::string>& words,
                                             bool merges, scan_shaper& shaper);

}  // namespace g4_tool
