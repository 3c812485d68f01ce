// SPDX-License-Identifier: MIT
// "did you mean": the known word that is nearest to a word that is not known.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace g4_tool {

/// "; did you mean 'scan'?" for the word of `known` that differs from `typed` by few letters, or begins
/// with it; the first of equally near ones. Empty where none is near, for numbers, and where `typed`
/// is known.
[[nodiscard]] std::string did_you_mean(std::string_view typed,
                                       const std::vector<std::string>& known);

}  // namespace g4_tool
