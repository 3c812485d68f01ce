// SPDX-License-Identifier: MIT
// A program with a heap: must not link for a microcontroller.
#include "check.hpp"

namespace self_test {
void put_number(std::size_t) {}
}  // namespace self_test

int* volatile kept;  // otherwise the compiler removes the allocation

int main() {
  kept = new int(1);
  return 0;
}
