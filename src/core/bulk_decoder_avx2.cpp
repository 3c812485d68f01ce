// SPDX-License-Identifier: MIT
// The kernels of the bulk decoder for processors with AVX2; compiled without special flags.
#include "bulk_kernels.hpp"

#if G4LIDAR_HAS_AVX2_KERNELS

#include <cassert>

#define G4LIDAR_KERNEL_TARGET __attribute__((target("avx2")))
#define G4LIDAR_KERNEL_LANES 8
#include "bulk_kernel.hpp"

namespace g4lidar::bulk {

const kernels& avx2_kernels_of(sample_format format) noexcept {
  const kernels* const found = find_kernels<vector_kernels>(format);
  assert(found != nullptr);
  return *found;
}

}  // namespace g4lidar::bulk

#endif
