// SPDX-License-Identifier: MIT
// The file of --mask.
#pragma once

#include <string>

#include "g4lidar/export/mask.hpp"

namespace g4_tool {

/// The mask in the file of that name. Throws a failure that names the file and the line.
[[nodiscard]] g4lidar::mask load_mask(const std::string& path);

}  // namespace g4_tool
