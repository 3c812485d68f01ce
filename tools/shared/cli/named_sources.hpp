// SPDX-License-Identifier: MIT
// Several lidars on a command line: NAME=SOURCE, and --mount NAME=X,Y,DEG.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "g4lidar/motion.hpp"
#include "verbs.hpp"

namespace g4_tool {

struct named_source {
  std::string name;  ///< Empty for the only one.
  std::string source;
  std::optional<g4lidar::mounting> mount;
};

/// The name of a lidar (empty for the only one) and its mounting.
using named_mounting = std::pair<std::string, g4lidar::mounting>;

/// Whether it can be the name of a lidar: letters, digits and _, and no digit at its begin. *Pure.*
[[nodiscard]] bool is_lidar_name(std::string_view word) noexcept;

/// The arguments "SOURCE" and "NAME=SOURCE", as words for named_sources(). `only`: without one.
[[nodiscard]] option_row named_source_arguments(std::vector<std::string>& into, const char* only);
/// --mount of one lidar, or of one of several; may be repeated.
[[nodiscard]] option_row named_mount_row(std::vector<named_mounting>& into);
/// --merge.
[[nodiscard]] option_row merge_row(bool& into);

/// The lidars of the words "SOURCE" and "NAME=SOURCE", at least one. Throws bad_value: several without names, with
/// `merges` files, and mountings of others.
[[nodiscard]] std::vector<named_source> named_sources(const std::vector<std::string>& words,
                                                      const std::vector<named_mounting>& mounts,
                                                      bool merges);

}  // namespace g4_tool
