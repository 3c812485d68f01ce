// SPDX-License-Identifier: MIT
// What is wrong with options: the two parts of problem_with().
#pragma once

#include <optional>

#include "g4lidar/error.hpp"
#include "g4lidar/lidar_options.hpp"

namespace g4lidar {

/// With the settings, which depend on the model; null: of a G4. *Pure.*
[[nodiscard]] std::optional<error> problem_with_settings(const lidar_options& options) noexcept;

/// With all else. *Pure.*
[[nodiscard]] std::optional<error> problem_with_use(const lidar_options& options) noexcept;

}  // namespace g4lidar
