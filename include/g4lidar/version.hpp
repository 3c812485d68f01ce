// SPDX-License-Identifier: MIT
// The version of the library; the build system and the packages read it from here.
#pragma once

#define G4LIDAR_VERSION_MAJOR 0
#define G4LIDAR_VERSION_MINOR 1
#define G4LIDAR_VERSION_PATCH 0

namespace g4lidar {

/// A version, as Semantic Versioning counts: a minor version adds, a major one breaks. Before 1.0 a
/// minor one may break too.
struct version {
  int major_number;
  int minor_number;
  int patch_number;
};

/// The version of these headers, for a program that wants to tell or to compare it; for the
/// preprocessor the macros above say the same.
inline constexpr version header_version{G4LIDAR_VERSION_MAJOR, G4LIDAR_VERSION_MINOR,
                                        G4LIDAR_VERSION_PATCH};

}  // namespace g4lidar
