// SPDX-License-Identifier: MIT
// A ring whose capacity is not a power of two would fail at a wrap of its counters: it does not
// compile.
// expect: the capacity of a point_ring is a power of two
#include "g4lidar/core/point_ring.hpp"

#ifdef MISUSE
constexpr std::size_t capacity = 3;
#else
constexpr std::size_t capacity = 4;
#endif

std::uint64_t misuse() {
  static g4lidar::point_ring<capacity> ring;
  return ring.written();
}
