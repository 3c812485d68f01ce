// SPDX-License-Identifier: MIT
// The verb sim with --link: simulated G4s on pseudo-terminals, until somebody says stop.
#pragma once

#include "sim_command.hpp"

namespace g4_dump {

/// Serves `scene` until a signal comes. Returns the exit code; throws a failure.
[[nodiscard]] int serve(const sim_options& options, const g4lidar::sim::world& scene);

/// Refuses, by a failure, what makes no sense.
void refuse_nonsense_to_serve(const sim_options& options);

}  // namespace g4_dump
