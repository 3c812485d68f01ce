// SPDX-License-Identifier: MIT
#include "text_signs.hpp"

namespace g4lidar {
namespace {

constexpr std::uint8_t interpret = 0xFF;  // begins each command of telnet
constexpr std::uint8_t carriage_return = 0x0D;
constexpr std::uint8_t line_feed = 0x0A;

bool is_blank(std::uint8_t byte) noexcept {
  return byte == ' ' || byte == '\t' || byte == carriage_return || byte == line_feed;
}
bool is_printable(std::uint8_t byte) noexcept { return byte >= ' ' && byte <= '~'; }
bool is_hex_digit(std::uint8_t byte) noexcept {
  return (byte >= '0' && byte <= '9') || (byte >= 'A' && byte <= 'F') ||
         (byte >= 'a' && byte <= 'f');
}

}  // namespace

void text_signs::take(bytes input) noexcept {
  for (const std::uint8_t byte : input) {
    ++count_;
    ++each_[byte];
    if (byte == line_feed && last_[0] == carriage_return) ++crlf_;
    if (byte == 0xBD && last_[0] == 0xBF && last_[1] == 0xEF) ++replaced_;
    if (option_ > 0) {
      --option_;
    } else if (is_half_) {
      is_half_ = false;
      const bool is_command = byte >= 0xFB && byte <= 0xFE;
      doubled_ += byte == interpret ? 1 : 0;
      negotiated_ += is_command ? 1 : 0;
      single_ += byte != interpret && !is_command ? 1 : 0;
      option_ = is_command ? 1 : 0;
    } else {
      is_half_ = byte == interpret;
    }
    take_word_byte(byte);
    last_ = {byte, last_[0], last_[1]};
  }
}

void text_signs::take_word_byte(std::uint8_t byte) noexcept {
  if (!is_blank(byte)) {
    const bool is_colon = byte == ':' && word_size_ >= 7;
    is_hex_word_ = is_hex_word_ && (is_hex_digit(byte) || is_colon);
    word_size_ += is_colon ? 0 : 1;
    return;
  }
  if (word_size_ > 0) end_word();
  if (byte == line_feed) {
    ++lines_;
    is_first_word_ = true;
  }
}

void text_signs::end_word() noexcept {
  constexpr unsigned offset_digits = 7;
  if (is_first_word_ && is_hex_word_ && word_size_ >= offset_digits && word_size_ <= 8) {
    ++offsets_;
  } else {
    ++words_;
    if (is_hex_word_ && word_size_ % 2 == 0) ++hex_words_;
  }
  word_size_ = 0;
  is_hex_word_ = true;
  is_first_word_ = false;
}

bool text_signs::is_text() const noexcept {
  constexpr std::uint64_t fewest = 16;
  std::uint64_t characters = 0;
  for (unsigned byte = 0; byte < each_.size(); ++byte) {
    const auto value = static_cast<std::uint8_t>(byte);
    if (is_printable(value) || is_blank(value)) characters += each_[byte];
  }
  return count_ >= fewest && characters >= count_ - count_ / 50;
}

text_kind text_signs::text() const noexcept {
  if (!is_text()) return text_kind::none;
  // A dump has its characters behind the bytes.
  const bool has_offsets = offsets_ >= 2 && 10 * offsets_ >= 9 * lines_;
  if (has_offsets && 2 * hex_words_ >= words_) return text_kind::hexdump;
  const bool has_digits = count_ > 0 && words_ > 0 ? 20 * hex_words_ >= 19 * words_ : is_hex_word_;
  return has_digits ? text_kind::hex : text_kind::plain;
}

// In the stream of a lidar each of these bytes is about one in 256 or more frequent.
stream_change text_signs::change() const noexcept {
  constexpr std::uint64_t few = 8;
  if (is_text()) return stream_change::none;
  const bool has_doubled = doubled_ >= few && 16 * single_ <= doubled_;
  if (negotiated_ > 0 && single_ == 0 && doubled_ + negotiated_ >= 2 && has_doubled)
    return stream_change::telnet;
  if (negotiated_ >= 3 && single_ == 0) return stream_change::telnet;
  if (replaced_ >= few && 8 * replaced_ >= count_of(0xBF)) {
    std::uint64_t others = 0;
    for (unsigned byte = 0x80; byte < 0x100; ++byte) {
      if (byte != 0xEF && byte != 0xBF && byte != 0xBD) others += each_[byte];
    }
    if (8 * others <= replaced_) return stream_change::utf8;
  }
  if (count_of(line_feed) >= few && crlf_ == count_of(line_feed)) return stream_change::crlf;
  constexpr std::uint64_t enough = 8'192;
  const std::uint64_t taken =
      count_of(0x03) + count_of(0x04) + count_of(carriage_return) + count_of(0x11) + count_of(0x13);
  if (count_ >= enough && taken == 0 && count_of(line_feed) >= few)
    return stream_change::cooked_line;
  return stream_change::none;
}

}  // namespace g4lidar
