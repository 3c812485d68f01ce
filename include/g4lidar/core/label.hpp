// SPDX-License-Identifier: MIT
// The names by which people call lidars: the words of the table in any spelling, and products that have another
// protocol.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "g4lidar/detail/cpp20.hpp"

namespace g4lidar {

namespace detail {

/// Takes the next character that counts from `rest`, in lower case; -1 at the end. *Pure.*
[[nodiscard]] constexpr int next_of_label(std::string_view& rest) noexcept {
  while (!rest.empty()) {
    const char next = rest.front();
    rest.remove_prefix(1);
    if (next == ' ' || next == '-' || next == '_') continue;
    return next >= 'A' && next <= 'Z' ? next - 'A' + 'a' : next;
  }
  return -1;
}

/// `label` without the name of the maker before it. *Pure.*
[[nodiscard]] constexpr std::string_view without_maker(std::string_view label) noexcept {
  std::string_view rest = label;
  constexpr std::string_view maker = "ydlidar";
  for (const char letter : maker) {
    if (next_of_label(rest) != letter) return label;
  }
  return rest;
}

struct other_label {
  std::string_view label;
  std::string_view word;
};
inline constexpr std::array<other_label, 4> other_labels{
    {{"G2B", "g2"},
     {"X2N", "x2"},
     {"S2 with intensity", "s2-intensity"},
     {"S2 Pro with intensity", "s2-pro-intensity"}}};

/// A product of the manufacturer with another protocol, and the numbers that identify it; 0: none is known.
struct other_product {
  std::uint8_t first;
  std::uint8_t last;
  std::string_view name;
};
inline constexpr std::array<other_product, 16> other_products{{{23, 23, "R3"},
                                                               {51, 51, "GS1"},
                                                               {52, 52, "GS2"},
                                                               {53, 53, "GS5"},
                                                               {54, 54, "GS6"},
                                                               {110, 110, "TEA"},
                                                               {130, 130, "TSA"},
                                                               {131, 131, "TSA Pro"},
                                                               {160, 160, "SDM15"},
                                                               {161, 161, "SDM18"},
                                                               {200, 200, "T15 or T30"},
                                                               {210, 212, "TIA"},
                                                               {0, 0, "T15"},
                                                               {0, 0, "T30"},
                                                               {0, 0, "COIN-D4"},
                                                               {0, 0, "LDS-03"}}};

}  // namespace detail

/// Whether both are the same name: "T-mini Pro", "tminipro", "YDLIDAR T_MINI_PRO". Case, blanks, hyphens, underscores
/// and the name of the maker do not count. *Pure.*
[[nodiscard]] constexpr bool is_same_label(std::string_view a, std::string_view b) noexcept {
  a = detail::without_maker(a);
  b = detail::without_maker(b);
  while (true) {
    const int next = detail::next_of_label(a);
    if (next != detail::next_of_label(b)) return false;
    if (next < 0) return true;
  }
}

/// Whether `label` names the model with this word in any spelling, or by another label that its devices have: "X2N" is
/// an "x2". *Pure.*
[[nodiscard]] constexpr bool is_label_of(std::string_view label, std::string_view word) noexcept {
  for (const detail::other_label& each : detail::other_labels) {
    if (each.word == word && is_same_label(label, each.label)) return true;
  }
  return is_same_label(label, word);
}

/// Another product of the same manufacturer, which identifies itself with `id` and has another protocol; empty if none
/// is known. Valid forever. *Pure.*
[[nodiscard]] constexpr std::string_view other_product(std::uint8_t id) noexcept {
  for (const detail::other_product& each : detail::other_products) {
    if (id != 0 && each.first <= id && id <= each.last) return each.name;
  }
  return {};
}

/// The same by its label, in any spelling. *Pure.*
[[nodiscard]] constexpr std::string_view other_product(std::string_view label) noexcept {
  for (const detail::other_product& each : detail::other_products) {
    if (is_same_label(label, each.name)) return each.name;
  }
  return {};
}

}  // namespace g4lidar
