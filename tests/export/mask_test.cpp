// SPDX-License-Identifier: MIT
// Masks from text: what is read, and every error with its line.
#include "g4lidar/options/filter_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <clocale>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "../support/test_scale.hpp"

namespace g4lidar::test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

mask read(std::string_view text) {
  auto made = parse_mask(text);
  const auto* const wrong = std::get_if<mask_error>(&made);
  EXPECT_EQ(wrong, nullptr) << wrong->line << ' ' << wrong->message;
  return wrong == nullptr ? std::get<mask>(std::move(made)) : mask();
}

void expect_error(std::string_view text, std::size_t line, std::string_view message) {
  const auto made = parse_mask(text);
  const auto* const wrong = std::get_if<mask_error>(&made);
  ASSERT_NE(wrong, nullptr) << text.substr(0, 60);
  EXPECT_EQ(wrong->line, line) << wrong->message;
  EXPECT_THAT(wrong->message, HasSubstr(std::string(message)));
  for (const char c : wrong->message) EXPECT_TRUE(c >= ' ' && c <= '~');
}

TEST(Mask, PolygonsInTheirOrder_WithCommentsAndAnySpaces) {
  const mask made = read(
      "# poles\n"
      "\n"
      "polygon 0.1 -0.1  0.2 -0.1  0.2 +0.1  # front\r\n"
      "\tpolygon\t-1 0 0 1 .5 -1. 2 2");
  ASSERT_EQ(made.polygons().size(), 2U);
  EXPECT_THAT(made.polygons()[0],
              ElementsAre(corner{0.1F, -0.1F}, corner{0.2F, -0.1F}, corner{0.2F, 0.1F}));
  EXPECT_THAT(made.polygons()[1],
              ElementsAre(corner{-1, 0}, corner{0, 1}, corner{0.5F, -1}, corner{2, 2}));
}

TEST(Mask, StaysValidWhenMoved) {
  mask made = read("polygon 0 0 1 0 1 1\npolygon 0 0 1 0 0 1");
  const mask moved = std::move(made);
  EXPECT_THAT(moved.polygons()[0], ElementsAre(corner{0, 0}, corner{1, 0}, corner{1, 1}));
  EXPECT_THAT(moved.polygons()[1], ElementsAre(corner{0, 0}, corner{1, 0}, corner{0, 1}));
}

TEST(Mask, Errors_NameTheLine) {
  expect_error("", 0, "there is no line 'polygon");
  expect_error("# nothing\n\n", 0, "there is no line 'polygon");
  expect_error("\nwall 0 0 1 1\n", 2, "'wall' is unknown; a line begins with 'polygon' or '#'");
  expect_error("polygon 0 0 1 0 1 1\npolygon 0 0 1 0 1 x\n", 2, "'x' is not a number");
  expect_error("polygon", 1, "found 0 numbers");
  expect_error("polygon 1", 1, "found 1 number");
  expect_error("polygon 0 0 1 0", 1, "found 4 numbers");
  expect_error("polygon 0 0 1 0 1 1 2", 1, "found 7 numbers");
  expect_error("polygon 0 0 1 1 2 2", 1, "on one line");
  expect_error("polygon 1 1 1 1 1 1", 1, "on one line");
  expect_error("polygon 0 0 1 0 1 100.1", 1, "beyond 100 m");
  expect_error("polygon 0 0 1 0 1 -101", 1, "beyond 100 m");
  expect_error("polygon \x1B[2J\xFF 0", 1, "is not a number");
  for (const char* const number :
       {"nan", "inf", "1e1", "0x1", "1,5", "+-1", "--1", "1.2.3", "+", "."}) {
    expect_error("polygon 0 0 1 0 1 " + std::string(number), 1, "is not a number");
  }
}

TEST(Mask, Limits) {
  std::string corners = "polygon";
  for (std::size_t i = 0; i < max_mask_corners; ++i) corners += i % 2 == 0 ? " 0 0" : " 1 0.5";
  expect_error(corners, 1, "on one line");
  corners.replace(corners.rfind("0.5"), 3, "0.6");
  EXPECT_EQ(read(corners).polygons()[0].size(), max_mask_corners);
  expect_error(corners + " 0 0", 1, "more than 1000 corners");
  std::string polygons;
  for (std::size_t i = 0; i < max_mask_polygons; ++i) polygons += "polygon 0 0 1 0 1 1\n";
  EXPECT_EQ(read(polygons).polygons().size(), max_mask_polygons);
  expect_error(polygons + "polygon 0 0 1 0 1 1\n", 1001, "more than 1000 polygons");
}

// A text of any words is a mask, or has an error in one of its lines.
TEST(Mask, AnyWords) {
  constexpr std::array<std::string_view, 12> words{
      "polygon ", "polygon ", "0 ", "1.5 ", "-2 ", "7 ", "\n", "#", "\t", "x", ".", "\xFF"};
  std::size_t masks = 0;
  for (const int seed : seeds(3000)) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    std::string text = "polygon 0 1 0 2 3 1 ";
    for (auto left = random() % 12; left > 0; --left) text += words[random() % words.size()];
    const auto made = parse_mask(text);
    if (const auto* const wrong = std::get_if<mask_error>(&made)) {
      const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) + 1;
      EXPECT_TRUE(wrong->line >= 1 && wrong->line <= lines) << text;
    } else {
      ++masks;
      for (const polygon& each : std::get<mask>(made).polygons())
        EXPECT_GE(each.size(), 3U) << text;
    }
  }
  EXPECT_GT(masks, 300U);
}

TEST(Mask, IsIndependentOfTheLocale) {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  if (std::setlocale(LC_ALL, "de_DE.UTF-8") == nullptr) GTEST_SKIP() << "no locale with a comma";
  EXPECT_THAT(read("polygon 0.5 0 1 0 1 1").polygons()[0],
              ElementsAre(corner{0.5F, 0}, corner{1, 0}, corner{1, 1}));
  std::setlocale(LC_ALL, before.c_str());
}

/// Why there is no mask at this path.
std::string why_not(const std::string& path) {
  const auto made = load_mask(path);
  const auto* const wrong = std::get_if<std::string>(&made);
  return wrong == nullptr ? "" : *wrong;
}

TEST(MaskFile, IsRead_AndAnErrorNamesTheFileTheLineAndWhatToDo) {
  const std::string advice = ". Give a file with lines 'polygon x1 y1 x2 y2 x3 y3 ...'.";
  const std::string directory = testing::TempDir();
  const std::string path = directory + "mask_test.txt";
  const std::string title = "mask: '" + path + "'";
  std::ofstream(path) << "# poles\npolygon 0 0 1 0 1 1\n";
  const auto made = load_mask(path);
  ASSERT_TRUE(std::holds_alternative<mask>(made)) << why_not(path);
  ASSERT_EQ(std::get<mask>(made).polygons().size(), 1U);
  EXPECT_TRUE(std::holds_alternative<mask>(load_mask(""))) << "no mask is wanted";

  std::ofstream(path) << "# poles\ncircle 0 0 1\n";
  EXPECT_EQ(why_not(path),
            title + ", line 2: 'circle' is unknown; a line begins with 'polygon' or '#'" + advice);
  std::ofstream(path) << "\n";
  EXPECT_THAT(why_not(path), AllOf(StartsWith(title + ": "), EndsWith(advice)));
  EXPECT_EQ(why_not(directory), "mask: '" + directory + "' is a directory" + advice);
  EXPECT_EQ(why_not("/nonexistent/mask"),
            "mask: '/nonexistent/mask' cannot be read: No such file or directory" + advice);
  std::ofstream(path) << std::string((std::size_t{16} << 20U) + 1, ' ');
  EXPECT_EQ(why_not(path), title + " is longer than 16 MB" + advice);
}

TEST(MaskFile, APipeOrADeviceIsRefusedWithoutAWait) {
  const std::string path = testing::TempDir() + "mask_test.fifo";
  ::unlink(path.c_str());
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  const std::string end =
      " is a pipe or a device, not a file. Give a file with lines 'polygon x1 y1 x2 y2 x3 y3 ...'.";
  EXPECT_EQ(why_not(path), "mask: '" + path + "'" + end);
  EXPECT_EQ(why_not("/dev/null"), "mask: '/dev/null'" + end);
  ::unlink(path.c_str());
}

}  // namespace
}  // namespace g4lidar::test
