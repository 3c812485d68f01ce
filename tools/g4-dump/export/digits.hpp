// SPDX-License-Identifier: MIT
// Numbers as text: whole ones, and those with a fixed number of decimals. Each put_...() writes to `at`, where there is
// room for its text, and returns the position behind it.
#pragma once

#include <algorithm>
#include <bit>
#include <charconv>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string_view>
#include <type_traits>

namespace g4_tool::digits {

/// Writes `text`.
inline char* put_text(char* out, std::string_view text) noexcept {
  return std::copy(text.begin(), text.end(), out);
}

/// Writes any number: at most 20 characters.
template <std::integral Number>
char* put_number(char* out, Number number) noexcept {
  constexpr int most = std::numeric_limits<Number>::digits10 + 1 + std::is_signed_v<Number>;
  return std::to_chars(out, out + most, number).ptr;
}

/// 10^`exponent`.
[[nodiscard]] consteval std::uint32_t power_of_ten(unsigned exponent) noexcept {
  return exponent == 0 ? 1U : 10U * power_of_ten(exponent - 1);
}

/// The nearest integer to `x`, 0 <= x < 2^51; ties to even, as printf rounds.
[[nodiscard]] constexpr std::uint64_t nearest(double x) noexcept {
  constexpr double shift = 0x1p52;  // from here on the last bit of a double has the value 1
  return std::bit_cast<std::uint64_t>(x + shift) - std::bit_cast<std::uint64_t>(shift);
}

/// Writes `scaled` / 10^Decimals with all its decimals: at most 21 characters.
template <unsigned Decimals, std::unsigned_integral Number>
char* put_scaled(char* out, Number scaled) noexcept {
  static_assert(Decimals >= 1 && Decimals <= 6);
  constexpr std::uint32_t one = power_of_ten(Decimals);
  const bool is_below_one = scaled < one;  // then one more keeps the zeros of the decimals
  char* const end = put_number(out, is_below_one ? scaled + one : scaled);
  char* const point = end - Decimals;
  std::memmove(point + 1, point, Decimals);
  *point = '.';
  if (is_below_one) *out = '0';
  return end + 1;
}

/// Writes x, 0 <= x * 10^Decimals < 2^51, rounded to this number of decimals. Faster than the form of std::to_chars for
/// fixed decimals, which also rounds the exact number, and not the product as here.
template <unsigned Decimals>
char* put_fixed(char* out, double x) noexcept {
  return put_scaled<Decimals>(out, nearest(x * power_of_ten(Decimals)));
}

/// An angle, 0 <= degrees < 360, in units of the last one of this number of decimals, below 360 degrees, too.
template <unsigned Decimals>
[[nodiscard]] std::uint32_t scaled_angle(double degrees) noexcept {
  const auto rounded = static_cast<std::uint32_t>(nearest(degrees * power_of_ten(Decimals)));
  return rounded < 360 * power_of_ten(Decimals) ? rounded : 0;
}

/// Writes an angle, 0 <= degrees < 360, rounded to this number of decimals. An angle that rounds to
/// 360 becomes 0: the text is also below 360.
template <unsigned Decimals>
char* put_angle(char* out, double degrees) noexcept {
  return put_scaled<Decimals>(out, scaled_angle<Decimals>(degrees));
}

/// Writes the angle in [0, 360) degrees as one in [-180, 180), rounded to this number of decimals.
/// An angle that rounds to 180 becomes -180.
template <unsigned Decimals>
char* put_signed_angle(char* out, double degrees) noexcept {
  constexpr std::uint32_t turn = 360 * power_of_ten(Decimals);
  const std::uint32_t scaled = scaled_angle<Decimals>(degrees);
  if (scaled < turn / 2) return put_scaled<Decimals>(out, scaled);
  *out++ = '-';
  return put_scaled<Decimals>(out, turn - scaled);
}

}  // namespace g4_tool::digits
