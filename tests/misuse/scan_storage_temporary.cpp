// SPDX-License-Identifier: MIT
// The assembler keeps a view of its storage: temporary storage does not compile.
// expect: (no matching (function|constructor)|could not convert|no (known|viable) conversion)
#include <vector>

#include "g4lidar/core/scan_assembler.hpp"

std::vector<g4lidar::point> make_storage() { return std::vector<g4lidar::point>(2000); }

int misuse() {
#ifdef MISUSE
  g4lidar::scan_assembler assembler(make_storage());
#else
  std::vector<g4lidar::point> storage = make_storage();
  g4lidar::scan_assembler assembler(storage);
#endif
  return assembler.finish() ? 1 : 0;
}
