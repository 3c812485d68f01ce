// SPDX-License-Identifier: MIT
// Exports symbols of a shared library: everything else is compiled as hidden.
#pragma once

#include "g4lidar/detail/cpp20.hpp"

/// Place it before the name of a public class with compiled members, and before each public
/// compiled function: `class G4LIDAR_API error`, `G4LIDAR_API bool is_g4_bridge(...)`. Inline
/// functions, templates and plain structs do not need it. `packaging/symbols` lists the resulting
/// symbols, and a test compares the libraries with the list. Static libraries consist of the same
/// objects as the shared ones.
#define G4LIDAR_API __attribute__((visibility("default")))

/// For private declarations inside such a class.
#define G4LIDAR_HIDDEN __attribute__((visibility("hidden")))
