// SPDX-License-Identifier: MIT
#include "mask_file.hpp"

#include "text_file.hpp"

namespace g4_tool {

g4lidar::mask load_mask(const std::string& path) {
  return load_text<g4lidar::mask>(
      path, 16, "Give a file with lines 'polygon x1 y1 x2 y2 x3 y3 ...'.", g4lidar::parse_mask);
}

}  // namespace g4_tool
