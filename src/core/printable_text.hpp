// SPDX-License-Identifier: MIT
// Text from users, devices and files without characters that a terminal or a log interprets.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace g4lidar {

using errno_word = const char* (*)(int);
/// " (ENOENT, No such file or directory)" with glibc's functions, empty for a number that they do not know; without
/// them, as before glibc 2.32, " (errno 2, No such file or directory)".
[[nodiscard]] std::string errno_text(int number, errno_word name, errno_word description);

/// The length in bytes of the first character of `text`, which is not empty; 0 if it is not valid
/// UTF-8. (RFC 3629, section 4)
constexpr std::size_t character_size(std::string_view text) noexcept {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::uint8_t first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t size = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < size) return 0;
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) return 0;
  }
  const bool is_too_long = (first == 0xE0 && byte(1) < 0xA0) || (first == 0xF0 && byte(1) < 0x90);
  const bool is_surrogate = first == 0xED && byte(1) > 0x9F;
  const bool is_beyond = first == 0xF4 && byte(1) > 0x8F;
  return is_too_long || is_surrogate || is_beyond ? 0 : size;
}

/// C0, DEL, and C1, which some terminals interpret in UTF-8 form.
constexpr bool is_control(std::string_view character) noexcept {
  const auto first = static_cast<std::uint8_t>(character[0]);
  if (character.size() == 1) return first < 0x20 || first == 0x7F;
  return first == 0xC2 && static_cast<std::uint8_t>(character[1]) < 0xA0;
}

/// Calls `put(piece)` for each character of `text`: as it is, or each of its bytes as `\x1B` if it is a control
/// character or not valid.
template <class Put>
constexpr void each_printable(std::string_view text, Put put) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  while (!text.empty()) {
    const std::size_t size = character_size(text);
    const std::string_view character = text.substr(0, size == 0 ? 1 : size);
    text.remove_prefix(character.size());
    if (size != 0 && !is_control(character)) {
      put(character);
      continue;
    }
    for (const char each : character) {
      const auto byte = static_cast<std::uint8_t>(each);
      const std::array<char, 4> escape{'\\', 'x', digits[byte >> 4U], digits[byte & 15U]};
      put(std::string_view(escape.data(), escape.size()));
    }
  }
}

}  // namespace g4lidar
