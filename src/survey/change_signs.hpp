// SPDX-License-Identifier: MIT
// Signs in a stream of bytes that something on the way has changed them: telnet, a transfer of text, a terminal.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "g4lidar/core/bytes.hpp"
#include "taken_bytes.hpp"

namespace g4lidar {

/// What something between the lidar and this program has done to the bytes.
enum class stream_change : std::uint8_t {
  none,
  telnet,      ///< Negotiation of telnet (RFC 854), and each FF doubled.
  crlf,        ///< A 0D was inserted before each 0A, by a transfer of text.
  utf8,        ///< Bytes above 7F were replaced by EF BF BD, as programs do that expect UTF-8.
  latin1,      ///< Bytes above 7F were read as Latin-1 and written as UTF-8: C2 or C3, and a byte.
  recoded,     ///< Bytes above 7F were read in another encoding and written as UTF-8.
  seven_bits,  ///< Bit 7 of each byte was taken, as by a line with seven data bits.
  flow_control,  ///< 11 and 13 were taken, by flow control with XON and XOFF.
  tabs,          ///< Each 09 was replaced by blanks.
  cooked_line,   ///< Control characters were taken or replaced, by a terminal in its usual mode.
};

/// *Single thread, never allocates.*
class change_signs {
 public:
  /// Control characters that are examined: all below 20.
  using control_set = taken_bytes::control_set;

  /// Adds bytes of the stream, in order.
  void take(bytes input) noexcept;
  /// What has changed bytes that are not text. A stream of some kilobytes shows it; flow control, some
  /// short packets.
  [[nodiscard]] stream_change change() const noexcept;
  /// The control characters of change() that did not arrive.
  [[nodiscard]] control_set missing() const noexcept;

 private:
  /// From AA to the checksum.
  static constexpr std::size_t header_size = 10;

  void take_telnet(std::uint8_t byte) noexcept;
  void take_utf8(std::uint8_t byte) noexcept;
  void take_header_byte(std::uint8_t byte) noexcept;
  void take_header() noexcept;
  [[nodiscard]] stream_change recoding() const noexcept;
  [[nodiscard]] std::uint64_t count_of(unsigned byte) const noexcept { return each_[byte]; }
  [[nodiscard]] bool is_replaced(unsigned control, std::uint64_t replaced) const noexcept;

  std::array<std::uint64_t, 256> each_{};
  std::array<std::uint8_t, 2> last_{};       // the newest first
  std::array<std::bitset<256>, 32> behind_;  // control characters, by the byte before them
  struct {
    std::uint64_t count = 0;  // of 0A behind 0D
    std::bitset<256> before;  // what was before such pairs
    std::bitset<256> behind;  // what was behind 0A
  } crlf_;
  std::uint64_t stripped_starts_ = 0;  // 2A 55: AA 55 without bit 7
  struct {
    std::uint64_t doubled = 0;     // pairs of FF
    std::uint64_t single = 0;      // FF before something else, but for negotiation
    std::uint64_t negotiated = 0;  // FF, FB to FE, and a byte
    bool is_half = false;          // one FF of a pair was seen
    bool is_option = false;        // the byte of a negotiation follows
  } telnet_;
  struct {
    std::array<std::uint64_t, 2> sequences{};  // of C2 and C3, of others
    std::uint64_t replaced = 0;                // EF BF BD
    std::uint64_t malformed = 0;
    unsigned awaited = 0;   // bytes of the sequence
    std::uint32_t sum = 0;  // of its bits
    std::uint8_t lead = 0;
  } utf8_;
  struct {
    std::array<std::uint8_t, header_size> bytes{};
    std::size_t size = 0;
    std::uint64_t count = 0;
    std::uint64_t even = 0;     // words of angles, which are odd
    std::uint64_t with_0a = 0;  // of these, by their lower byte
    std::uint64_t with_20 = 0;
  } headers_;
  taken_bytes taken_;
};

/// What it is and what to do, in sentences; of one that takes characters without them. Empty: none. Valid forever. *Pure.*
[[nodiscard]] std::string_view words_for(stream_change what) noexcept;

}  // namespace g4lidar
