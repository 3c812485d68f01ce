// SPDX-License-Identifier: MIT
// The version of the library; the build system and the packages read it from this file.
#pragma once

#include "g4lidar/detail/api.hpp"

#define G4LIDAR_VERSION_MAJOR 0
#define G4LIDAR_VERSION_MINOR 1
#define G4LIDAR_VERSION_PATCH 0

namespace g4lidar {

/// A version by Semantic Versioning: a minor version adds, a major version breaks. Before 1.0 a
/// minor version may break, too.
struct version {
  int major_number;
  int minor_number;
  int patch_number;
};

/// The version of these headers, for programs that print or compare it; the macros above are the
/// same for the preprocessor.
inline constexpr version header_version{G4LIDAR_VERSION_MAJOR, G4LIDAR_VERSION_MINOR,
                                        G4LIDAR_VERSION_PATCH};

}  // namespace g4lidar
