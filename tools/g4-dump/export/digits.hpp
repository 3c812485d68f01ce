// SPDX-License-Identifier: MIT
// Numbers as text, tens of millions per second: eight digits at a time in a 64-bit word. For the
// writers of this directory, and for programs that write columns of their own.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace g4_tool::digits {

/// How many bytes behind its text a put_...() may overwrite. Each of them writes to `at`, returns
/// the position behind its text, and needs room for the text and these bytes. *Never allocates,
/// never waits.*
inline constexpr std::size_t slack = 16;

/// Writes the eight characters of `text`, the first one in its lowest byte.
inline void put_word(char* at, std::uint64_t text) noexcept {
  if constexpr (std::endian::native == std::endian::big) text = __builtin_bswap64(text);
  std::memcpy(at, &text, sizeof text);
}

/// Writes `text`.
inline char* put_text(char* at, std::string_view text) noexcept {
  std::memcpy(at, text.data(), text.size());
  return at + text.size();
}

/// The eight digits of `number` < 10^8, including leading zeros, the first one in the lowest byte.
[[nodiscard]] constexpr std::uint64_t eight_digits(std::uint32_t number) noexcept {
  // Halves of four digits, then quarters of two, then single digits, each in a lane of its own.
  // 10486 / 2^20 and 103 / 2^10 approximate 1 / 100 and 1 / 10 exactly enough for these lanes.
  const std::uint64_t fours = number / 10'000U | (std::uint64_t{number % 10'000U} << 32);
  const std::uint64_t upper = ((fours * 10'486U) >> 20) & 0x0000'007F'0000'007FU;
  const std::uint64_t twos = upper | ((fours - 100U * upper) << 16);
  const std::uint64_t tens = ((twos * 103U) >> 10) & 0x000F'000F'000F'000FU;
  const std::uint64_t ones = tens | ((twos - 10U * tens) << 8);
  return ones | 0x3030'3030'3030'3030U;
}

/// Writes `number` < 10^8.
inline char* put_small(char* at, std::uint32_t number) noexcept {
  const std::uint64_t digits = eight_digits(number);
  // The last digit is written even if it is 0.
  const std::uint64_t significant = (digits & 0x0F0F'0F0F'0F0F'0F0FU) | (std::uint64_t{1} << 56);
  const int leading_bits = std::countr_zero(significant) & ~7;
  put_word(at, digits >> leading_bits);
  return at + 8 - leading_bits / 8;
}

/// Writes any number.
inline char* put_number(char* at, std::uint64_t number) noexcept {
  constexpr std::uint64_t word = 100'000'000;
  if (number >= word) {
    at = put_number(at, number / word);
    put_word(at, eight_digits(static_cast<std::uint32_t>(number % word)));
    return at + 8;
  }
  return put_small(at, static_cast<std::uint32_t>(number));
}

/// Numbers that usually increase in small steps, like times: the text of the part above 10^8 is
/// kept.
class growing_number {
 public:
  /// Writes `number` to `at`, at most 20 characters; returns the end of it.
  char* put(char* at, std::uint64_t number) noexcept {
    const std::uint64_t upper = number / 100'000'000U;
    const auto lower = static_cast<std::uint32_t>(number % 100'000'000U);
    if (upper == 0) return put_small(at, lower);
    if (upper != upper_) {
      upper_ = upper;
      length_ = put_number(text_.data(), upper) - text_.data();
    }
    std::memcpy(at, text_.data(), 16);
    at += length_;
    put_word(at, eight_digits(lower));
    return at + 8;
  }

 private:
  std::uint64_t upper_ = 0;
  std::ptrdiff_t length_ = 0;
  std::array<char, 32> text_{};  // 12 digits at most, and the overwritten bytes
};

/// 10^`exponent`.
[[nodiscard]] consteval std::uint32_t power_of_ten(unsigned exponent) noexcept {
  return exponent == 0 ? 1U : 10U * power_of_ten(exponent - 1);
}

/// The nearest integer to `x`, 0 <= x < 2^51; ties to even, as printf rounds.
[[nodiscard]] constexpr std::uint64_t nearest(double x) noexcept {
  constexpr double shift = 0x1p52;  // from here on the last bit of a double has the value 1
  return std::bit_cast<std::uint64_t>(x + shift) - std::bit_cast<std::uint64_t>(shift);
}

/// Writes `scaled` / 10^Decimals < 10^8 with all its decimals.
template <unsigned Decimals>
char* put_scaled(char* at, std::uint64_t scaled) noexcept {
  static_assert(Decimals >= 1 && Decimals <= 6);
  constexpr std::uint64_t point = '.';
  constexpr std::uint32_t one = power_of_ten(Decimals);
  std::uint64_t decimals = 0;
  if (scaled < 100'000'000) {  // all digits in one step, at least one of them before the point
    const std::uint64_t digits = eight_digits(static_cast<std::uint32_t>(scaled));
    constexpr std::uint64_t kept = std::uint64_t{1} << (8 * (7 - Decimals));
    const int leading_bits = std::countr_zero((digits & 0x0F0F'0F0F'0F0F'0F0FU) | kept) & ~7;
    put_word(at, digits >> leading_bits);
    at += 8 - Decimals - static_cast<unsigned>(leading_bits) / 8;
    decimals = digits;
  } else {
    at = put_small(at, static_cast<std::uint32_t>(scaled / one));
    decimals = eight_digits(static_cast<std::uint32_t>(scaled % one));
  }
  put_word(at, (decimals >> (8 * (8 - Decimals)) << 8) | point);
  return at + 1 + Decimals;
}

/// Writes 0 <= x < 10^8, rounded to this number of decimals.
template <unsigned Decimals>
char* put_fixed(char* at, double x) noexcept {
  return put_scaled<Decimals>(at, nearest(x * power_of_ten(Decimals)));
}

/// The integer degrees below 360 as text: at most three digits and the point, the first character
/// in the lowest byte; the highest byte has the number of characters.
inline constexpr auto whole_degrees = [] {
  std::array<std::uint64_t, 360> texts{};
  for (std::uint32_t degrees = 0; degrees < 360; ++degrees) {
    const unsigned count = degrees < 10 ? 1 : degrees < 100 ? 2 : 3;
    const std::uint64_t digits = eight_digits(degrees) >> (8 * (8 - count));
    const std::uint64_t point = std::uint64_t{'.'} << (8 * count);
    texts[degrees] = digits | point | std::uint64_t{count + 1} << 56;
  }
  return texts;
}();

/// Writes an angle, 0 <= degrees < 360, rounded to this number of decimals. An angle that rounds to
/// 360 becomes 0: the text is also below 360.
template <unsigned Decimals>
char* put_angle(char* at, double degrees) noexcept {
  constexpr std::uint32_t one = power_of_ten(Decimals);
  constexpr std::uint32_t turn = 360 * one;
  const auto rounded = static_cast<std::uint32_t>(nearest(degrees * one));
  const std::uint32_t scaled = rounded < turn ? rounded : 0;
  const std::uint64_t whole = whole_degrees[scaled / one];
  put_word(at, whole);
  at += whole >> 56;
  put_word(at, eight_digits(scaled % one) >> (8 * (8 - Decimals)));
  return at + Decimals;
}

/// Writes the angle in [0, 360) degrees as one in [-180, 180), rounded to this number of decimals.
/// An angle that rounds to 180 becomes -180.
template <unsigned Decimals>
char* put_signed_angle(char* at, double degrees) noexcept {
  constexpr std::uint32_t turn = 360 * power_of_ten(Decimals);
  const auto rounded = static_cast<std::uint32_t>(nearest(degrees * power_of_ten(Decimals)));
  const std::uint32_t scaled = rounded < turn ? rounded : 0;
  if (scaled < turn / 2) return put_scaled<Decimals>(at, scaled);
  *at++ = '-';
  return put_scaled<Decimals>(at, turn - scaled);
}

/// Writes any number, with its sign if it is negative.
inline char* put_signed(char* at, std::int64_t number) noexcept {
  if (number >= 0) return put_number(at, static_cast<std::uint64_t>(number));
  *at++ = '-';
  return put_number(at, std::uint64_t{0} - static_cast<std::uint64_t>(number));
}

}  // namespace g4_tool::digits
