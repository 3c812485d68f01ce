// SPDX-License-Identifier: MIT
// The verb sim: the bytes that a G4 in a world of walls would send.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "g4lidar/sim/scanner.hpp"
#include "g4lidar/sim/world.hpp"

namespace g4_dump {

struct sim_options {
  double seconds = 10.0;
  g4lidar::sim::scanner_options scanner;
  std::optional<std::string> world;  ///< The built-in one where none is given.
  std::optional<std::string> truth;
  std::string output = "-";
  // Served on ptys instead, one device for each link.
  std::vector<std::string> links;
  std::vector<std::string> serials;  ///< Of the first of them.
  std::vector<std::string> faults;   ///< Of each of them.
  bool log = false;
};

class output;

/// The walls that the options name; not in the file that `out` writes. Throws a failure.
[[nodiscard]] g4lidar::sim::world load_world(const sim_options& options, const output* out);

/// Returns the exit code; throws a failure.
[[nodiscard]] int run(const sim_options& options);

}  // namespace g4_dump
