// SPDX-License-Identifier: MIT
#include "text_signs.hpp"

#include <string_view>

namespace g4lidar {
namespace {

bool is_decimal_digit(std::uint8_t byte) noexcept { return byte >= '0' && byte <= '9'; }
bool is_hex_digit(std::uint8_t byte) noexcept {
  return is_decimal_digit(byte) || (byte >= 'A' && byte <= 'F') || (byte >= 'a' && byte <= 'f');
}
unsigned digit_of(std::uint8_t byte) noexcept {
  return is_decimal_digit(byte) ? byte - '0' : (byte | 0x20U) - 'a' + 10U;
}
bool ends_word(std::uint8_t byte) noexcept {
  constexpr std::string_view marks = ",;[](){}";
  return is_blank(byte) || marks.find(static_cast<char>(byte)) != std::string_view::npos;
}

}  // namespace

void text_signs::take(bytes input) noexcept {
  for (const std::uint8_t byte : input) {
    ++count_;
    if (is_of_text(byte)) ++characters_;
    if (count_ <= 2) begin_ = begin_ << 8U | byte;
    if (byte == 'x' && last_ == '\\') ++escapes_;
    take_word_byte(byte);
    last_ = byte;
  }
}

void text_signs::take_word_byte(std::uint8_t byte) noexcept {
  if (!ends_word(byte)) {
    // Bytes may have a colon or a hyphen between them.
    const bool separates = (byte == ':' || byte == '-') && word_.size > 0;
    word_.has_colon = byte == ':' && separates;
    if (separates && word_.size == 2) return end_word();
    if (separates) return;
    if (word_.size == 0) word_.first = byte;
    if (word_.size == 1) word_.second = byte;
    ++word_.size;
    word_.is_decimal = word_.is_decimal && is_decimal_digit(byte);
    if (word_.is_decimal && word_.number < 1000) word_.number = word_.number * 10 + digit_of(byte);
    const bool is_x = byte == 'x' && word_.size == 2 && word_.first == '0';
    if (is_x) return;
    word_.is_hex = word_.is_hex && is_hex_digit(byte);
    if (word_.is_hex) word_.value = word_.value << 4U | digit_of(byte);
    return;
  }
  if (word_.size > 0) end_word();
  if (byte == '\n') is_first_word_ = true;
}

/// At least four digits, first in its line, and larger than the one before: as in dumps.
bool text_signs::is_offset() const noexcept {
  const bool has_size = word_.size >= 4 && word_.size <= 16;
  return is_first_word_ && word_.is_hex && has_size && word_.second != 'x' &&
         (offsets_ == 0 || word_.value > offset_);
}

text_signs::word_counts text_signs::with_last() const noexcept {
  word_counts all = words_;
  const auto& [size, is_hex, is_decimal, has_colon, first, second, value, number] = word_;
  const bool is_c = is_hex && second == 'x' && size >= 3;
  const bool is_plain_hex = is_hex && second != 'x' && size > 0 && size % 2 == 0;
  all.all += size > 0 ? 1 : 0;
  all.hex += is_plain_hex ? 1 : 0;
  all.of_one_byte += is_plain_hex && size == 2 ? 1 : 0;
  all.of_two_bytes += is_plain_hex && size == 4 ? 1 : 0;
  all.c_numbers += is_c && size <= 4 ? 1 : 0;
  all.decimals += is_decimal && size > 0 && number < 256 ? 1 : 0;
  all.columns += size > 0 && (first == '|' || first == '>') ? 1 : 0;
  return all;
}

void text_signs::end_word() noexcept {
  const bool is_star = is_first_word_ && word_.size == 1 && word_.first == '*';
  if (is_star) {
    ++stars_;
  } else if (is_offset()) {
    if (offsets_++ == 0) begins_at_0_ = word_.value == 0;
    colons_ += word_.has_colon ? 1 : 0;
    offset_ = word_.value;
  } else {
    words_ = with_last();
  }
  lines_ += is_first_word_ && !is_star ? 1 : 0;
  word_ = {};
  is_first_word_ = false;
}

bool text_signs::is_text() const noexcept {
  constexpr std::uint64_t fewest = 16;
  return count_ >= fewest && characters_ >= count_ - count_ / 50;
}

text_kind text_signs::text() const noexcept {
  if (!is_text()) return text_kind::none;
  const word_counts words = with_last();
  const std::uint64_t fewest = begins_at_0_ ? 2 : 4;  // of a part, somewhere in it
  const bool has_offsets = offsets_ >= fewest && 10 * offsets_ >= 9 * lines_;
  // A dump has its characters behind the bytes.
  if (has_offsets || words.columns >= 2) {
    if (2 * words.of_one_byte >= words.all && colons_ == 0) return text_kind::byte_dump;
    const bool is_xxd = 10 * colons_ >= 9 * offsets_ && has_offsets &&
                        2 * (words.of_one_byte + words.of_two_bytes) >= words.all;
    if (is_xxd) return text_kind::xxd;
    if (has_offsets) return text_kind::other_dump;
  }
  const auto are_nearly_all = [&](std::uint64_t some) {
    return some > 0 && 20 * some >= 19 * words.all;
  };
  if (are_nearly_all(words.hex)) return text_kind::hex;
  if (10 * escapes_ >= count_) {
    constexpr unsigned b = 'b' << 8U;
    return begin_ == (b | '\'') || begin_ == (b | '"') ? text_kind::python : text_kind::escapes;
  }
  constexpr std::uint64_t enough = 8;
  if (words.c_numbers >= enough && 10 * words.c_numbers >= 8 * words.all) return text_kind::c_array;
  if (words.decimals >= enough && are_nearly_all(words.decimals)) return text_kind::numbers;
  return text_kind::plain;
}

}  // namespace g4lidar
