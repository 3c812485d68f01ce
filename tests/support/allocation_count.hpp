// SPDX-License-Identifier: MIT
// Counts the calls of the global operator new and delete in a piece of code.
#pragma once

#include <cstddef>

namespace g4lidar::test {

/// Calls of any global operator new and of any global operator delete, in this program so far.
/// Defined by allocation_count.cpp, which replaces them all.
[[nodiscard]] std::size_t allocations_so_far();

/// Whether every operator new fails from now on. Also defined there.
void refuse_memory(bool refused);

/// Calls `work`, which must not throw, while every operator new fails.
template <class Work>
void without_memory(Work&& work) {
  refuse_memory(true);
  work();
  refuse_memory(false);
}

/// The number of allocations and deallocations in `work`.
template <class Work>
[[nodiscard]] std::size_t allocations_in(Work&& work) {
  const std::size_t before = allocations_so_far();
  work();
  return allocations_so_far() - before;
}

}  // namespace g4lidar::test
