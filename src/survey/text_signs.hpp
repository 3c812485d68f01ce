// SPDX-License-Identifier: MIT
// Signs in a stream of bytes that it is text, and in which form it shows other bytes.
#pragma once

#include <cstddef>
#include <cstdint>

#include "g4lidar/core/bytes.hpp"

namespace g4lidar {

/// Blanks and ends of lines.
[[nodiscard]] constexpr bool is_blank(std::uint8_t byte) noexcept {
  return byte == ' ' || byte == '\t' || byte == '\r' || byte == '\n';
}
/// Characters of ASCII that text consists of.
[[nodiscard]] constexpr bool is_of_text(std::uint8_t byte) noexcept {
  return is_blank(byte) || (byte > ' ' && byte <= '~');
}

/// What text contains.
enum class text_kind : std::uint8_t {
  none,        ///< The bytes are not text.
  plain,       ///< Any text.
  hex,         ///< Bytes as two hexadecimal digits each: "AA 55 00 28", "aa:55", "aa550028".
  xxd,         ///< Lines of xxd: an offset and a colon, words of one or two bytes, characters.
  byte_dump,   ///< The same with single bytes and without a colon: of hexdump -C, or of od -t x1.
  other_dump,  ///< Lines with offsets, and words in another form: of hexdump, od, or od -c.
  c_array,     ///< Numbers of C: "0xAA, 0x55".
  python,      ///< A literal of Python: "b'\xaaU\x00('".
  escapes,     ///< The same with something else around it: "\xaa\x55".
  numbers,     ///< A list of decimal numbers up to 255: "[170, 85, 0, 40]".
};

/// *Single thread, never allocates.*
class text_signs {
 public:
  /// Adds bytes of the stream, in order.
  void take(bytes input) noexcept;

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  /// Whether nearly all bytes are printable characters and line ends; false below 16 bytes.
  [[nodiscard]] bool is_text() const noexcept;
  [[nodiscard]] text_kind text() const noexcept;
  /// Whether a dump leaves equal lines out, and has "*" for them.
  [[nodiscard]] bool leaves_out() const noexcept { return stars_ > 0; }

 private:
  /// What is between blanks, commas and brackets.
  struct word {
    unsigned size = 0;
    bool is_hex = true;
    bool is_decimal = true;
    bool has_colon = false;
    std::uint8_t first = 0;
    std::uint8_t second = 0;
    std::uint64_t value = 0;  // of its hexadecimal digits
    unsigned number = 0;      // of its decimal digits
  };
  struct word_counts {
    std::uint64_t all = 0;  // but for offsets
    std::uint64_t hex = 0;  // of two digits, or of a multiple
    std::uint64_t of_one_byte = 0;
    std::uint64_t of_two_bytes = 0;
    std::uint64_t c_numbers = 0;
    std::uint64_t decimals = 0;
    std::uint64_t columns = 0;  // characters behind the bytes: "|...|", ">...<"
  };

  void take_word_byte(std::uint8_t byte) noexcept;
  void end_word() noexcept;
  [[nodiscard]] bool is_offset() const noexcept;
  [[nodiscard]] word_counts with_last() const noexcept;

  std::uint64_t count_ = 0;
  std::uint64_t characters_ = 0;
  std::uint64_t escapes_ = 0;  // "\x"
  unsigned begin_ = 0;         // the first two characters
  std::uint8_t last_ = 0;
  word word_;
  word_counts words_;
  bool is_first_word_ = true;  // of its line
  std::uint64_t lines_ = 0;    // with words
  std::uint64_t stars_ = 0;    // lines that are "*"
  std::uint64_t offsets_ = 0;  // first in their line, each larger than the one before
  std::uint64_t colons_ = 0;   // behind offsets
  std::uint64_t offset_ = 0;   // the last one
  bool begins_at_0_ = false;
};

}  // namespace g4lidar
