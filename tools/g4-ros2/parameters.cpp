// SPDX-License-Identifier: MIT
#include "parameters.hpp"

#include "io/shape_files.hpp"

namespace g4_tool {

lidar_parameters parameters_of(const common_options& how,
                               const std::map<std::string, std::string>& words, bool merges,
                               scan_shaper& shaper) {
  shaping_options shape = shape_of(how, {});
  shape.for_merging = merges;
  shape.restamps = true;  // nobody is to deskew the points of a message again
  const filter_settings start{shape.filter, how.ignored, how.marks, how.grid};
  return {shape, start, mask_in(how.mask), words, shaper};
}

}  // namespace g4_tool
