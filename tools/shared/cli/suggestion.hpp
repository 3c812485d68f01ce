// SPDX-License-Identifier: MIT
// Comparison of words: "did you mean" with the known word that is nearest to an unknown one.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace g4_tool {

/// `text` with its ASCII letters in lower case.
[[nodiscard]] std::string lowered(std::string_view text);

/// "; did you mean 'scan'?" for the word of `known` that differs from `typed` by few letters or begins
/// with it; the first of equally near ones. Empty if none is near, for numbers, and if `typed` is
/// known.
[[nodiscard]] std::string did_you_mean(std::string_view typed,
                                       const std::vector<std::string>& known);

}  // namespace g4_tool
