// SPDX-License-Identifier: MIT
// Which answers of four bytes are those to command 93, with the commands and without; and what is added to angles.
#include "g4lidar/core/reply_watch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "g4lidar/core/model.hpp"

namespace g4lidar {
namespace {

using byte_vector = std::vector<std::uint8_t>;
using known_by = zero_offset::stated_by;

/// `A5 5A`, length 4, type 4.
byte_vector number(std::int32_t value) {
  byte_vector made{0xA5, 0x5A, 4, 0, 0, 0, 4};
  const auto bits = static_cast<std::uint32_t>(value);
  for (unsigned shift = 0; shift < 32; shift += 8) {
    made.push_back(static_cast<std::uint8_t>(bits >> shift));
  }
  return made;
}
const byte_vector header{0xA5, 0x5A, 5, 0, 0, 0x40, 0x81};

std::optional<zero_angle> heard(reply_watch& by, const byte_vector& reply, const model& which) {
  const auto view = response_view::from(reply, true);
  EXPECT_TRUE(view);
  return view ? by.take(*view, which).zero : std::nullopt;
}

/// family: G1, G2, G2A, G2C, R2 and TG answer 93; in 1/4 degrees, an R2 in 1/100.
struct having {
  const char* word;
  int per_degree;
  int least_chz;  ///< Of the replies about the frequency: 5 to 12 Hz; of a TG 3 to 16 Hz, and 0.4 Hz too much.
  int most_chz;
};
constexpr std::array all{having{"g1", 4, 500, 1200},   having{"g2", 4, 500, 1200},
                         having{"g2a", 4, 500, 1200},  having{"g2c", 4, 500, 1200},
                         having{"r2", 100, 500, 1200}, having{"tg15", 4, 340, 1640},
                         having{"tg30", 4, 340, 1640}, having{"tg50", 4, 340, 1640}};

TEST(ReplyWatch, TheTableIsWhole) {
  for (const model& row : models) {
    const bool is_listed =
        std::ranges::any_of(all, [&](const having& each) { return each.word == row.word; });
    EXPECT_EQ(row.zero_angle_divisor != 0, is_listed) << row.word;
  }
}

TEST(ReplyWatch, WithoutCommands_WhatCanBeAFrequencyIsNone) {
  for (const having& each : all) {
    const model& which = *model_named(each.word);
    for (int value = each.least_chz; value <= each.most_chz; value += 10) {
      reply_watch by;
      EXPECT_FALSE(heard(by, number(value), which)) << each.word << " " << value;
    }
  }
}

TEST(ReplyWatch, WithoutCommands_WhatCanOnlyBeAnAngleIsFound) {
  for (const having& each : all) {
    const model& which = *model_named(each.word);
    for (const int value : {-360 * each.per_degree, -295, -1, 0, 4, 299}) {
      reply_watch by;
      const auto found = heard(by, number(value), which);
      ASSERT_TRUE(found) << each.word << " " << value;
      EXPECT_DOUBLE_EQ(found->deg(), static_cast<double>(value) / each.per_degree);
      EXPECT_FALSE(heard(by, number(360 * each.per_degree + 1000), which)) << "beyond a turn";
    }
  }
}

// No lidar answers a command there: a scan runs. It is the place where an answer is repeated.
TEST(ReplyWatch, WithoutCommands_BehindAScanHeaderEachAngleIsFound) {
  for (const having& each : all) {
    const model& which = *model_named(each.word);
    for (int deg = -360; deg <= 360; deg += 15) {
      reply_watch by;
      EXPECT_FALSE(heard(by, header, which));
      const auto found = heard(by, number(deg * each.per_degree), which);
      ASSERT_TRUE(found) << each.word << " " << deg;
      EXPECT_DOUBLE_EQ(found->deg(), deg);
      EXPECT_FALSE(heard(by, number(each.least_chz), which)) << "one answer alone";
    }
    reply_watch by;
    EXPECT_FALSE(heard(by, header, which));
    by.pass();
    EXPECT_FALSE(heard(by, number(each.least_chz), which)) << "behind a packet";
  }
}

TEST(ReplyWatch, WithCommands_TheAnswerTo93IsFound) {
  for (const having& each : all) {
    const model& which = *model_named(each.word);
    reply_watch by;
    by.sent(std::array<std::uint8_t, 2>{0xA5, 0x0D});
    EXPECT_FALSE(heard(by, number(each.least_chz), which));
    EXPECT_FALSE(heard(by, number(-4), which)) << "whatever it is";
    by.sent(std::array<std::uint8_t, 2>{0xA5, 0x93});
    for (int deg = -360; deg <= 360; deg += 15) {
      const auto found = heard(by, number(deg * each.per_degree), which);
      ASSERT_TRUE(found) << each.word << " " << deg;
      EXPECT_DOUBLE_EQ(found->deg(), deg);
    }
  }
}

TEST(ReplyWatch, OfOtherModels_NothingIsFound) {
  for (const model& row : models) {
    if (row.zero_angle_divisor != 0) continue;
    reply_watch by;
    by.sent(std::array<std::uint8_t, 2>{0xA5, 0x93});
    EXPECT_FALSE(heard(by, number(8), row)) << row.word;
  }
}

// The manufacturer's program calls 180 degrees uncorrected, and adds them.
TEST(ZeroOffset, EachAngleIsAdded) {
  for (int deg = -360; deg <= 360; deg += 15) {
    zero_offset of;
    EXPECT_FALSE(of.angle());
    of.set({100 * deg}, known_by::device);
    std::array<point, 720> points{};
    for (std::size_t i = 0; i < points.size(); ++i) points[i].angle_deg = static_cast<float>(i) / 2;
    of.add_to(points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto angle_deg = static_cast<double>(points[i].angle_deg);
      EXPECT_GE(angle_deg, 0.0);
      EXPECT_LT(angle_deg, 360.0);
      EXPECT_NEAR(std::remainder(angle_deg - static_cast<double>(i) / 2 - deg, 360.0), 0.0, 1e-3)
          << deg;
    }
  }
}

TEST(ZeroOffset, TheMostReliableIsUsed) {
  zero_offset of;
  of.set({100}, known_by::device);
  of.set({200}, known_by::device);
  EXPECT_EQ(of.angle()->cdeg, 200);
  of.set({300}, known_by::recording);
  of.set({400}, known_by::device);
  EXPECT_EQ(of.angle()->cdeg, 300);
  of.set({500}, known_by::user);
  of.set({600}, known_by::recording);
  EXPECT_EQ(of.angle()->cdeg, 500);
}

}  // namespace
}  // namespace g4lidar
