// SPDX-License-Identifier: MIT
// What is recognised in the golden vectors of the family and in the captures, which are not part of the
// project.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "g4lidar/core/layout_recogniser.hpp"

namespace g4lidar {
namespace {

using byte_vector = std::vector<std::uint8_t>;

const model& recognised(const byte_vector& data) {
  layout_recogniser seen;
  seen.take(data);
  seen.finish();
  return seen.most_likely();
}

const std::filesystem::path shared = G4LIDAR_SOURCE_DIR "/../shared";

byte_vector bytes_of_hex(const std::string& name) {
  std::ifstream file(shared / "family" / (name + ".hex"));
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  std::string digits;
  std::ranges::copy_if(text, std::back_inserter(digits),
                       [](unsigned char c) { return std::isxdigit(c) != 0; });
  byte_vector all;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2) {
    all.push_back(static_cast<std::uint8_t>(std::stoi(digits.substr(i, 2), nullptr, 16)));
  }
  return all;
}

byte_vector bytes_of_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

TEST(RecognisedFiles, TheGoldenVectors) {
  if (!std::filesystem::exists(shared / "family")) {
    GTEST_SKIP() << "The golden vectors of the family are not at hand: there is no directory "
                    "shared/family beside the project.";
  }
  struct row {
    std::string name;
    std::size_t size;
    std::string usual;
  };
  const std::vector<row> rows{
      {"tri2-real-usv", 2, "g4"},          {"tof2-real-tg15", 2, "g4"},
      {"coin-d4-real", 3, "t-mini-pro"},   {"tri2-half-synth", 2, "g4"},
      {"tri3-i10-synth", 3, "t-mini-pro"}, {"tri3-i8f2-synth", 3, "t-mini-pro"},
      {"scl3-synth", 3, "t-mini-pro"},     {"tof3-tmini-synth", 3, "t-mini-pro"},
      {"tof2-mm-synth", 2, "g4"},          {"tof4-sh-synth", 4, "t-mini-plus-sh"}};
  for (const row& each : rows) {
    const byte_vector once = bytes_of_hex(each.name);
    ASSERT_FALSE(once.empty()) << each.name;
    byte_vector all;
    for (int i = 0; i < 5; ++i) all.insert(all.end(), once.begin(), once.end());
    layout_recogniser seen;
    seen.take(all);
    seen.finish();
    EXPECT_EQ(seen.sample_bytes(), each.size) << each.name;
    EXPECT_EQ(seen.most_likely().word, each.usual) << each.name;
  }
  byte_vector flagged;
  for (int i = 0; i < 10; ++i) {
    const byte_vector once = bytes_of_hex("tri2-flags-synth");
    flagged.insert(flagged.end(), once.begin(), once.end());
  }
  layout_recogniser seen;
  seen.take(flagged);
  EXPECT_EQ(seen.sample_bytes(), 2U);
  EXPECT_EQ(recognised(bytes_of_file(shared / "family" / "ct-info-synth.bin")).word, "x2");
}

// No recording of a G4 is known; these devices have its packets, and were always read as one.
TEST(RecognisedFiles, TheCapturesStayThoseOfAG4) {
  if (!std::filesystem::exists(shared / "captures")) {
    GTEST_SKIP() << "The captures are not at hand: there is no directory shared/captures beside "
                    "the project.";
  }
  for (const auto* const name : {"x4_scan1", "x4_stream", "x2_packet", "zero_packet"}) {
    const byte_vector all = bytes_of_file(shared / "captures" / (std::string(name) + ".bin"));
    ASSERT_FALSE(all.empty()) << name;
    EXPECT_EQ(recognised(all).word, "g4") << name;
  }
}

}  // namespace
}  // namespace g4lidar
