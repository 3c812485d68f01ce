// SPDX-License-Identifier: MIT
// What is wrong with options: the two parts of problem_with().
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include "g4lidar/error.hpp"
#include "g4lidar/lidar_options.hpp"
#include "g4lidar/options/option_table.hpp"
#include "g4lidar/transport/recognition.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar {

/// With the model that is given, where `whose` states another one ("the source"): its samples have another size, or it is
/// sure of its model, and the user does not insist. Nothing if they agree, or one is null. *Allocates.*
[[nodiscard]] std::optional<error> problem_with_model(const lidar_options& options,
                                                      const recognition& stated,
                                                      std::string_view whose);
/// With the settings, which depend on the model; null: of a G4. *Pure.*
[[nodiscard]] std::optional<error> problem_with_settings(const lidar_options& options) noexcept;

/// Bits of option_user.
using option_users = std::uint8_t;

/// With the options that are given, and that none of `users` can use. *Pure.*
[[nodiscard]] std::optional<error> problem_with_users(const lidar_options& options,
                                                      option_users users) noexcept;
/// The same options without these. *Pure.*
[[nodiscard]] lidar_options without_others(lidar_options options, option_users users);

/// As connector_for(): `at_any_rate`: a named model is searched at other rates than its own, too.
[[nodiscard]] result<std::unique_ptr<connector>> connector_for(const lidar_options& options,
                                                               bool at_any_rate);

/// With all else. *Pure.*
[[nodiscard]] std::optional<error> problem_with_use(const lidar_options& options) noexcept;

}  // namespace g4lidar
