// SPDX-License-Identifier: MIT
// The path of a file that follows another one.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace g4lidar {

/// "walk-0001.mcap" for "walk.mcap" and 1. Allocates.
[[nodiscard]] inline std::string numbered_path(std::string_view first, std::uint64_t number) {
  constexpr std::string_view extension = ".mcap";
  const bool has_extension = first.ends_with(extension);
  if (has_extension) first.remove_suffix(extension.size());
  std::array<char, 24> digits{};
  std::snprintf(digits.data(), digits.size(), "-%04llu", static_cast<unsigned long long>(number));
  return std::string(first) + digits.data() + (has_extension ? std::string(extension) : "");
}

/// The paths of the files that follow a first one.
class numbered_paths {
 public:
  explicit numbered_paths(std::string_view first) : first_(first) {}
  /// Each has a number of its own. Allocates.
  [[nodiscard]] std::string next() { return numbered_path(first_, ++number_); }

 private:
  std::string first_;
  std::uint64_t number_ = 0;
};

}  // namespace g4lidar
