// SPDX-License-Identifier: MIT
// A correction is no layout, although both have few values.
// expect: (cannot convert|could not convert|cannot initialize|no known conversion)
#include "g4lidar/core/model.hpp"

std::size_t misuse() {
  using namespace g4lidar;
#ifdef MISUSE
  constexpr sample_format format{correction_kind::none, sample_layout::whole_mm};
#else
  constexpr sample_format format{sample_layout::whole_mm, correction_kind::none};
#endif
  return sample_size(format.layout);
}
