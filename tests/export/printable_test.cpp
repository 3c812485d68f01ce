// SPDX-License-Identifier: MIT
// Texts of a device or a file: no bytes that a terminal interprets, and valid JSON.
#include "g4lidar/error.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "support/test_scale.hpp"

namespace g4lidar::test {
namespace {

TEST(Printable, LeavesTextUnchanged) {
  EXPECT_EQ(printable(""), "");
  EXPECT_EQ(printable("/dev/ttyUSB0 (G4)"), "/dev/ttyUSB0 (G4)");
  EXPECT_EQ(printable("K\xC3\xBC"
                      "che \xE2\x82\xAC \xF0\x9F\x98\x80"),
            "K\xC3\xBC"
            "che \xE2\x82\xAC \xF0\x9F\x98\x80");
}

TEST(Printable, EscapesTerminalControls) {
  EXPECT_EQ(printable("\x1B[2J\x1B]0;title\x07"), "\\x1B[2J\\x1B]0;title\\x07");
  EXPECT_EQ(printable("a\r\nb\tc"),
            "a\\x0D\\x0Ab\\x09"
            "c");
  EXPECT_EQ(printable(std::string_view("\0\x7F", 2)), "\\x00\\x7F");
  EXPECT_EQ(printable("\xC2\x9B"
                      "31m"),
            "\\xC2\\x9B31m")
      << "CSI as one character";
  EXPECT_EQ(printable("\x9B"
                      "31m"),
            "\\x9B31m")
      << "CSI as one byte";
}

TEST(Printable, IsReversible) { EXPECT_EQ(printable("\\x1B"), "\\\\x1B"); }

TEST(Printable, EscapesInvalidUtf8) {
  EXPECT_EQ(printable("\xC3"), "\\xC3");
  EXPECT_EQ(printable("\xC3(\x80"), "\\xC3(\\x80");
  EXPECT_EQ(printable("\xC0\xAF"), "\\xC0\\xAF") << "longer than it needs to be";
  EXPECT_EQ(printable("\xE0\x80\xAF"), "\\xE0\\x80\\xAF");
  EXPECT_EQ(printable("\xED\xA0\x80"), "\\xED\\xA0\\x80") << "half of a pair";
  EXPECT_EQ(printable("\xF4\x90\x80\x80"), "\\xF4\\x90\\x80\\x80") << "beyond U+10FFFF";
  EXPECT_EQ(printable("\xFF"), "\\xFF");
}

void expect_printable(const std::string& bytes) {
  const std::string shown = printable(bytes);
  for (std::size_t at = 0; at < shown.size(); ++at) {
    const auto byte = static_cast<unsigned char>(shown[at]);
    ASSERT_GE(byte, 0x20U);
    ASSERT_NE(byte, 0x7FU);
    if (byte == 0xC2) {
      ASSERT_GE(static_cast<unsigned char>(shown.at(at + 1)), 0xA0U);
    }
  }
  ASSERT_NO_THROW(static_cast<void>(nlohmann::json(shown).dump())) << "no valid UTF-8";
}

TEST(Printable, AnyBytes_LeaveNoControlCharacter) {
  for (const int seed : seeds(1)) {
    std::mt19937 random(static_cast<std::uint32_t>(seed));
    for (int i = 0; i < 20'000; ++i) {
      std::string bytes(random() % 12, '\0');
      for (char& byte : bytes) byte = static_cast<char>(random());
      ASSERT_NO_FATAL_FAILURE(expect_printable(bytes)) << seed;
    }
  }
}

}  // namespace
}  // namespace g4lidar::test
