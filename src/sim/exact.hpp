// SPDX-License-Identifier: MIT
// Included first by every source of g4lidar::sim: refuses a compiler that is configured to round
// differently from IEEE 754 doubles, one operation at a time. Otherwise the same seed would not
// give the same bytes.
#pragma once

#include <cfloat>
#include <limits>

static_assert(std::numeric_limits<double>::is_iec559 && std::numeric_limits<double>::digits == 53);

// 0: as the type requires; 1: float as double, which leaves double alone; 2 would be the x87.
static_assert(FLT_EVAL_METHOD == 0 || FLT_EVAL_METHOD == 1,
              "g4lidar::sim needs doubles without excess precision (x86: -msse2 -mfpmath=sse)");

#if defined(__FAST_MATH__)
#error "g4lidar::sim must not be compiled with -ffast-math"
#endif

#if defined(__clang__)
#pragma clang fp contract(off)
#endif

// A compiler does not report whether it fuses a * b + c. src/CMakeLists.txt sets this definition
// together with -ffp-contract=off, and the golden digests in the tests detect a failure.
#if !defined(G4LIDAR_SIM_UNFUSED)
#error "compile g4lidar::sim with -ffp-contract=off -DG4LIDAR_SIM_UNFUSED"
#endif
