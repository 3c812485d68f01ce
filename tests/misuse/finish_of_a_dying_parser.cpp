// SPDX-License-Identifier: MIT
// Finishing a temporary parser would return views into it: this does not compile.
// expect: deleted function.*stream_parser::finish|call to deleted member function 'finish'
#include "g4lidar/core/stream_parser.hpp"

bool misuse() {
#ifdef MISUSE
  const auto found = g4lidar::stream_parser{}.finish();
#else
  g4lidar::stream_parser parser;
  const auto found = parser.finish();
#endif
  return found.has_value();
}
