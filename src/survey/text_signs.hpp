// SPDX-License-Identifier: MIT
// Signs in a stream of bytes that it is text, went through something made for text, or came through telnet.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "g4lidar/core/bytes.hpp"

namespace g4lidar {

/// What text contains.
enum class text_kind : std::uint8_t {
  none,     ///< The bytes are not text.
  plain,    ///< Any text.
  hex,      ///< Bytes as two hexadecimal digits each: "AA 55 00 28".
  hexdump,  ///< Lines with an offset and such bytes, as hexdump, xxd and od -x write them.
};

/// What something between the lidar and this program has done to the bytes.
enum class stream_change : std::uint8_t {
  none,
  telnet,       ///< Negotiation of telnet (RFC 854), and each FF doubled.
  crlf,         ///< A 0D was inserted before each 0A, by a transfer of text.
  utf8,         ///< Bytes above 7F were replaced by EF BF BD, as programs do that expect UTF-8.
  cooked_line,  ///< Bytes are missing that a terminal line in its usual mode takes: 03, 04, 0D, 11, 13.
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
  /// What has changed bytes that are not text. A stream of some kilobytes shows it.
  [[nodiscard]] stream_change change() const noexcept;

 private:
  [[nodiscard]] std::uint64_t count_of(unsigned byte) const noexcept { return each_[byte]; }
  void take_word_byte(std::uint8_t byte) noexcept;
  void end_word() noexcept;

  std::uint64_t count_ = 0;
  std::array<std::uint64_t, 256> each_{};
  std::array<std::uint8_t, 3> last_{};  // the newest first
  std::uint64_t crlf_ = 0;              // 0A behind 0D
  std::uint64_t replaced_ = 0;          // EF BF BD
  std::uint64_t doubled_ = 0;           // pairs of FF
  std::uint64_t single_ = 0;            // FF before something else, but for negotiation
  std::uint64_t negotiated_ = 0;        // FF, FB to FE, and a byte
  bool is_half_ = false;                // one FF of a pair was seen
  unsigned option_ = 0;                 // the byte of a negotiation that follows
  // Words of text: what is between blanks.
  unsigned word_size_ = 0;
  bool is_hex_word_ = true;
  bool is_first_word_ = true;    // of its line
  std::uint64_t words_ = 0;      // but for offsets
  std::uint64_t hex_words_ = 0;  // of two digits, or of a multiple
  std::uint64_t offsets_ =
      0;  // words of at least seven digits, maybe with a colon, first in their line
  std::uint64_t lines_ = 0;
};

}  // namespace g4lidar
