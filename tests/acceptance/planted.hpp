// SPDX-License-Identifier: MIT
// Differences from the table of models that are planted in simulated lidars, one at a time.
#pragma once

#include <functional>
#include <span>
#include <string_view>

#include "bench.hpp"

namespace g4_tool::acceptance::test {

/// A lidar of the model `word` with a difference in this field of the table, and the step and the fact that show it.
struct planted {
  std::string_view field;
  std::string_view word;
  std::function<void(bench&)> plant;
  step found_by;
  std::string_view text;
};

[[nodiscard]] std::span<const planted> all_planted();

}  // namespace g4_tool::acceptance::test
