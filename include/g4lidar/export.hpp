// SPDX-License-Identifier: MIT
// Marks what a shared library shows: the libraries are compiled with everything else hidden.
#pragma once

/// Before the name of a public class that has something compiled in it, and before each public function
/// that is compiled: `class G4LIDAR_API error`, `G4LIDAR_API bool is_g4_bridge(...)`. What is inline or
/// a template needs none, and neither does a plain struct. `packaging/symbols` lists what comes of it,
/// and a test holds the libraries against that. The same for static libraries, whose objects are those
/// of the shared ones.
#define G4LIDAR_API __attribute__((visibility("default")))

/// For what is declared inside such a class and is nobody's business.
#define G4LIDAR_HIDDEN __attribute__((visibility("hidden")))
