// SPDX-License-Identifier: MIT
// Messages of the library to a program, in the words of the tool's commands and options.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace g4_dump {

/// Words in errors and advice of the library that only a program can follow, and what a user of the
/// tool does instead.
struct tool_word {
  std::string_view library;
  std::string_view tool;
};
[[nodiscard]] std::span<const tool_word> tool_words() noexcept;

/// `text` of the library with all of them replaced.
[[nodiscard]] std::string in_tool_words(std::string_view text);

}  // namespace g4_dump
