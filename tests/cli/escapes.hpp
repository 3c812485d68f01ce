// SPDX-License-Identifier: MIT
// What no output may contain: control characters, C1 controls in both forms, and bytes that are no UTF-8.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace cli {

/// How long the UTF-8 character at `at` is; 0 where there is none. Written apart from the tool's own.
inline std::size_t utf8_length(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<std::uint8_t>(text[i]) : std::uint8_t{0};
  };
  std::uint32_t value = byte(at);
  std::size_t length = 1;
  if (value >= 0x80) {
    if (value < 0xC0 || value >= 0xF8) return 0;
    length = value < 0xE0 ? 2 : value < 0xF0 ? 3 : 4;
    value &= 0x7FU >> length;
    for (std::size_t i = 1; i < length; ++i) {
      if ((byte(at + i) & 0xC0U) != 0x80U) return 0;
      value = value * 64 + (byte(at + i) & 0x3FU);
    }
    constexpr std::uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    if (value < least[length] || value > 0x10FFFF || (value >= 0xD800 && value < 0xE000)) return 0;
  }
  return length;
}

/// The first place of `text` that a terminal would obey or that is no UTF-8, with its surroundings; empty
/// where there is none. Ends of lines may be there.
inline std::string unescaped_in(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_length(text, at);
    const auto first = static_cast<std::uint8_t>(text[at]);
    const bool is_c0 = length == 1 && first != '\n' && (first < 0x20 || first == 0x7F);
    const bool is_c1 =
        length == 2 && first == 0xC2 && static_cast<std::uint8_t>(text[at + 1]) < 0xA0;
    if (length == 0 || is_c0 || is_c1) {
      char code[40];
      std::snprintf(code, sizeof code, "0x%02X at %zu", first, at);
      return code;
    }
    at += length;
  }
  return {};
}

}  // namespace cli
