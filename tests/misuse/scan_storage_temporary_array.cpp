// SPDX-License-Identifier: MIT
// The assembler keeps a view of its storage: a temporary array does not compile.
// expect: (no matching (function|constructor)|could not convert|no (known|viable) conversion)
#include <array>

#include "g4lidar/core/scan_assembler.hpp"

int misuse() {
#ifdef MISUSE
  g4lidar::scan_assembler assembler(std::array<g4lidar::point, 100>{});
#else
  std::array<g4lidar::point, 100> storage{};
  g4lidar::scan_assembler assembler(storage);
#endif
  return assembler.finish() ? 1 : 0;
}
