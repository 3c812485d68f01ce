// SPDX-License-Identifier: MIT
// A program with a heap: must not link for a microcontroller.
#include "check.hpp"

namespace self_test {
void put_number(std::size_t) {}
}  // namespace self_test

int* volatile kept;  // else the compiler sees that it can do without

int main() {
  kept = new int(1);
  return 0;
}
