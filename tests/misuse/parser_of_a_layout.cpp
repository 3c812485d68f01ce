// SPDX-License-Identifier: MIT
// A layout alone is no format: a parser also needs to know how many samples a packet has.
// expect: (no matching function|no matching constructor)
#include "g4lidar/core/stream_parser.hpp"

std::size_t misuse() {
  using g4lidar::sample_layout;
#ifdef MISUSE
  const g4lidar::stream_parser parser(sample_layout::intensity_8);
#else
  const g4lidar::stream_parser parser({sample_layout::intensity_8, g4lidar::correction_kind::none});
#endif
  return parser.held();
}
