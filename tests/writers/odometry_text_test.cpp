// SPDX-License-Identifier: MIT
// Odometry from text: what is read, and every error with its line.
#include "io/odometry_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "../support/test_scale.hpp"

namespace g4lidar::test {
namespace {

using namespace g4_tool;
using ::testing::HasSubstr;

void expect_error(std::string_view text, std::size_t line, std::string_view message) {
  const auto made = parse_odometry(text);
  const auto* const wrong = std::get_if<odometry_error>(&made);
  ASSERT_NE(wrong, nullptr) << text.substr(0, 60);
  EXPECT_EQ(wrong->line, line) << wrong->message;
  EXPECT_THAT(wrong->message, HasSubstr(std::string(message)));
  for (const char c : wrong->message) EXPECT_TRUE(c >= ' ' && c <= '~');
}

TEST(OdometryText, PosesInTheirOrder_WithCommentsAndAnySpaces) {
  const auto made = parse_odometry(
      "# wheels\n"
      "0 0.000000 0.000000 0.000000\n"
      "\n"
      "20000000\t1.5 -2e-05  +3.25  # turned\r\n"
      "  9000000000000000 -1 .5 -0.1");
  const auto* const poses = std::get_if<std::vector<stamped_pose>>(&made);
  ASSERT_NE(poses, nullptr);
  ASSERT_EQ(poses->size(), 3U);
  EXPECT_EQ((*poses)[0].time_ns, 0);
  EXPECT_EQ((*poses)[1].time_ns, 20'000'000);
  EXPECT_EQ((*poses)[1].pose, (pose_2d{1.5, -2e-5, 3.25}));
  EXPECT_EQ((*poses)[2].time_ns, 9'000'000'000'000'000);
  EXPECT_EQ((*poses)[2].pose, (pose_2d{-1.0, 0.5, -0.1}));
}

TEST(OdometryText, ErrorsHaveTheirLine) {
  const std::string good = "0 0 0 0\n1 0 0 0\n";
  expect_error("", 0, "there is no line");
  expect_error("# nothing\n", 0, "there is no line");
  expect_error(good + "2 0 0", 3, "less than the 4 numbers");
  expect_error(good + "2 0 0 0 0", 3, "more than the 4 numbers");
  expect_error(good + "\n2.5 0 0 0", 4, "'2.5' is not a time in whole nanoseconds");
  expect_error(good + "0x2 0 0 0", 3, "'0x2' is not a time");
  expect_error(good + "4611686018427387904 0 0 0", 3, "is not a time");
  expect_error("-4611686018427387904 0 0 0", 1, "is not a time");
  expect_error("-99999999999999999999 0 0 0", 1, "is not a time");
  expect_error(good + "1 0 0 0", 3, "'1' is not later than");
  expect_error("2 0 0 0\n1 0 0 0\n", 2, "'1' is not later than");
  expect_error("time_ns x y yaw\n", 1, "'time_ns' is not a time");
  for (const std::string word : {"x", "nan", "inf", "1,5", "1.0m", "+-1", "\x01"}) {
    expect_error(good + "2 0 " + word + " 0", 3, "is not a number");
  }
  expect_error(good + "2 0 0 1000001", 3, "'1000001' is above 1000000");
  expect_error(good + "2 -1e7 0 0", 3, "'-1e7' is above 1000000");
}

/// Any text gives poses that other functions accept, or an error.
TEST(OdometryText, AnyText) {
  constexpr std::string_view characters = "0123456789 .-e+#\n\t\rx";
  for (const int seed : test::seeds(100)) {
    std::mt19937 dice(static_cast<std::uint32_t>(seed));
    std::string text;
    for (int line = 0; line < 3; ++line) {
      text += std::to_string(dice() % 100) + " 1 2 0.5\n";
      if (dice() % 2 == 0) text.insert(dice() % text.size(), 1, characters[dice() % 20]);
    }
    const auto made = parse_odometry(text);
    const auto* const poses = std::get_if<std::vector<stamped_pose>>(&made);
    if (poses == nullptr) continue;
    for (std::size_t i = 1; i < poses->size(); ++i) {
      EXPECT_GT((*poses)[i].time_ns, (*poses)[i - 1].time_ns) << text;
    }
  }
}

}  // namespace
}  // namespace g4lidar::test
