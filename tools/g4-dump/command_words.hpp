// SPDX-License-Identifier: MIT
// What the commands of the protocol are called in what people read.
#pragma once

#include <cstdint>
#include <string_view>

namespace g4_dump {

/// "start", "health?"; "no command" where there is none of that code. It lives for ever.
[[nodiscard]] std::string_view word_for_command(std::uint8_t code) noexcept;

}  // namespace g4_dump
