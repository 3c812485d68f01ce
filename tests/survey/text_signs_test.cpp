// SPDX-License-Identifier: MIT
#include "survey/text_signs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace g4lidar {
namespace {

using byte_list = std::vector<std::uint8_t>;

byte_list of(std::string_view text) { return {text.begin(), text.end()}; }

text_signs seen_in(const byte_list& all, std::size_t piece = 4096) {
  text_signs seen;
  for (std::size_t at = 0; at < all.size(); at += piece) {
    seen.take(bytes(all).subspan(at, std::min(piece, all.size() - at)));
  }
  return seen;
}

/// Bytes in which each value is as frequent as every other.
byte_list binary(std::size_t count) {
  std::mt19937 random(7);
  byte_list all(count);
  for (std::uint8_t& each : all) each = static_cast<std::uint8_t>(random());
  return all;
}

std::string hex_of(std::uint8_t byte) {
  std::array<char, 3> digits{};
  std::snprintf(digits.data(), digits.size(), "%02x", byte);
  return digits.data();
}

/// As `xxd -p`, with `separator` between bytes.
std::string hex_text(const byte_list& all, std::string_view separator) {
  std::string text;
  for (std::size_t i = 0; i < all.size(); ++i) {
    text += hex_of(all[i]);
    text += i % 16 == 15 ? "\n" : separator;
  }
  return text;
}

TEST(TextSigns, KnowText) {
  EXPECT_EQ(seen_in(of("$GNGGA,023634.00,4004.73,N,11614.19,E\r\n")).text(), text_kind::plain);
  EXPECT_EQ(seen_in(of("RP LIDAR System.\r\nFirmware Ver 1.29")).text(), text_kind::plain);
  EXPECT_EQ(seen_in(binary(4000)).text(), text_kind::none);
  EXPECT_EQ(seen_in(of("short")).text(), text_kind::none);
}

TEST(TextSigns, KnowBytesThatAreWrittenAsText) {
  const byte_list all = binary(2000);
  for (const std::string_view separator : {" ", "", "  ", "\t", ":", "-", ", "}) {
    EXPECT_EQ(seen_in(of(hex_text(all, separator))).text(), text_kind::hex) << separator;
  }
  std::string upper = hex_text(all, " ");
  std::ranges::transform(upper, upper.begin(),
                         [](char c) { return c >= 'a' ? static_cast<char>(c - 32) : c; });
  EXPECT_EQ(seen_in(of(upper)).text(), text_kind::hex);
}

TEST(TextSigns, ASentenceOfHexDigitsAndWordsIsPlain) {
  EXPECT_EQ(seen_in(of("a bad face fed a dead bee at the cafe in december 2026\n")).text(),
            text_kind::plain);
}

}  // namespace
}  // namespace g4lidar
