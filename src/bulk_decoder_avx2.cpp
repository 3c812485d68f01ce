// SPDX-License-Identifier: MIT
// The kernels of the bulk decoder for processors with AVX2 and FMA; compiled without special flags.
#include "bulk_kernels.hpp"

#if G4LIDAR_HAS_AVX2_KERNELS

namespace g4lidar::bulk {

const kernels avx2_kernels = portable_kernels;

}  // namespace g4lidar::bulk

#endif
