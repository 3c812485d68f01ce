// SPDX-License-Identifier: MIT
#include "g4lidar/export/printable.hpp"

#include <cstddef>
#include <cstdint>

namespace g4lidar {
namespace {

/// The length in bytes of the first character of `text`, which is not empty; 0 if it is not valid
/// UTF-8. (RFC 3629, section 4)
std::size_t character_size(std::string_view text) noexcept {
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

void put_hex(std::string& to, char byte) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  to += "\\x";
  to += digits[static_cast<std::uint8_t>(byte) >> 4U];
  to += digits[static_cast<std::uint8_t>(byte) & 0x0FU];
}

/// C0, DEL, and C1, which some terminals interpret in UTF-8 form.
bool is_control(std::string_view character) noexcept {
  const auto first = static_cast<std::uint8_t>(character[0]);
  if (character.size() == 1) return first < 0x20 || first == 0x7F;
  return first == 0xC2 && static_cast<std::uint8_t>(character[1]) < 0xA0;
}

}  // namespace

std::string printable(std::string_view text) {
  std::string shown;
  while (!text.empty()) {
    const std::size_t size = character_size(text);
    const std::string_view character = text.substr(0, size == 0 ? 1 : size);
    if (character == "\\") {
      shown += "\\\\";
    } else if (size == 0 || is_control(character)) {
      for (const char byte : character) put_hex(shown, byte);
    } else {
      shown += character;
    }
    text.remove_prefix(character.size());
  }
  return shown;
}

}  // namespace g4lidar
