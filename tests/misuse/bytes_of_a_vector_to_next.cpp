// SPDX-License-Identifier: MIT
// A vector is not a view that next() could shorten: the conversion would be a temporary.
// expect: cannot bind non-const lvalue reference|no matching member function for call to 'next'
#include <cstdint>
#include <vector>

#include "g4lidar/core/stream_parser.hpp"

bool misuse(g4lidar::stream_parser& parser, std::vector<std::uint8_t>& received) {
#ifdef MISUSE
  const auto found = parser.next(received);
#else
  g4lidar::bytes input(received);
  const auto found = parser.next(input);
#endif
  return found.has_value();
}
