// SPDX-License-Identifier: MIT
// How every public header begins: the standard that it needs, and what a shared library exports.
#pragma once

// One clear message from compilers with an older standard. Every public header includes this,
// directly or indirectly, before other headers of this library.
#if __cplusplus < 202002L
#error "libg4lidar needs C++20: compile with -std=c++20 or later"
// A missing file ends the compilation; otherwise hundreds of errors would hide the message above.
#include <libg4lidar-needs-c++20>
#endif

/// Exports symbols of a shared library: everything else is compiled as hidden. Place it before the
/// name of a public class with compiled members, and before each public
/// compiled function: `class G4LIDAR_API error`, `G4LIDAR_API bool is_g4_bridge(...)`. Inline
/// functions, templates and plain structs do not need it. `packaging/symbols` lists the resulting
/// symbols, and a test compares the libraries with the list. Static libraries consist of the same
/// objects as the shared ones.
#define G4LIDAR_API __attribute__((visibility("default")))

/// For private declarations inside such a class.
#define G4LIDAR_HIDDEN __attribute__((visibility("hidden")))
