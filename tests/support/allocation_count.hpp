// SPDX-License-Identifier: MIT
// Counts the calls of the global operator new and delete in a stretch of code.
#pragma once

#include <cstddef>

namespace g4lidar::test {

/// Calls of any global operator new and of any global operator delete, in this program so far.
/// Defined by allocation_count.cpp, which replaces them all.
[[nodiscard]] std::size_t allocations_so_far();

/// Whether from now on there is no memory for any operator new. Defined there, too.
void refuse_memory(bool refused);

/// Does `work`, which does not throw, while there is none.
template <class Work>
void without_memory(Work&& work) {
  refuse_memory(true);
  work();
  refuse_memory(false);
}

/// How often `work` allocates or frees.
template <class Work>
[[nodiscard]] std::size_t allocations_in(Work&& work) {
  const std::size_t before = allocations_so_far();
  work();
  return allocations_so_far() - before;
}

}  // namespace g4lidar::test
