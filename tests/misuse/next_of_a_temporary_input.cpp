// SPDX-License-Identifier: MIT
// next() shortens its input: a temporary input, whose rest the caller would never see, does not
// compile.
// expect: cannot bind non-const lvalue reference|no matching member function for call to 'next'
#include <array>
#include <cstdint>

#include "g4lidar/core/stream_parser.hpp"

std::array<std::uint8_t, 100> received;

bool misuse(g4lidar::stream_parser& parser) {
#ifdef MISUSE
  const auto found = parser.next(g4lidar::bytes(received));
#else
  g4lidar::bytes input(received);
  const auto found = parser.next(input);
#endif
  return found.has_value();
}
