// SPDX-License-Identifier: MIT
// The man page and the completions, made from the table of verbs when the project is built.
#pragma once

#include <string>
#include <string_view>

namespace g4_dump {

/// The man page g4-dump(1), in the language of man(7).
[[nodiscard]] std::string man_page();
[[nodiscard]] std::string bash_completion();
[[nodiscard]] std::string zsh_completion();
[[nodiscard]] std::string fish_completion();

/// `g4-dump --generate man|bash|zsh|fish`, which the build runs: prints it; returns the exit code.
[[nodiscard]] int generate(std::string_view what);

}  // namespace g4_dump
