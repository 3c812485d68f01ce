// SPDX-License-Identifier: MIT
// The views in an event may point into the parser's carry: next() of a temporary parser does not
// compile.
// expect: deleted function.*stream_parser::next|call to deleted member function 'next'
#include "g4lidar/core/stream_parser.hpp"

bool misuse(g4lidar::bytes input) {
#ifdef MISUSE
  const auto found = g4lidar::stream_parser{}.next(input);
#else
  g4lidar::stream_parser parser;
  const auto found = parser.next(input);
#endif
  return found.has_value();
}
