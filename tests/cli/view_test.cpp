// SPDX-License-Identifier: MIT
// The picture of `g4-dump view`, without a terminal. All expected cells were calculated by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "program.hpp"
#include "view/canvas.hpp"
#include "view/picture.hpp"
#include "view/radar.hpp"
#include "view/trails.hpp"

namespace g4_tool {
namespace {

using g4lidar::point;

point at(float angle_deg, float range_m) {
  return {.angle_deg = angle_deg, .range_mm = range_m * 1000.0F};
}

TEST(Canvas, EachDotOfABrailleCell_HasItsBit) {
  canvas on(1, 1, glyphs::braille);
  char32_t expected = 0x2800;
  for (const auto& [x, y, bit] : std::vector<std::tuple<int, int, char32_t>>{{0, 0, 0x01},
                                                                             {0, 1, 0x02},
                                                                             {0, 2, 0x04},
                                                                             {1, 0, 0x08},
                                                                             {1, 1, 0x10},
                                                                             {1, 2, 0x20},
                                                                             {0, 3, 0x40},
                                                                             {1, 3, 0x80}}) {
    on.dot(x, y, ink::points);
    expected += bit;
    EXPECT_EQ(on.at(0, 0), (canvas_cell{expected, ink::points}));
  }
  EXPECT_EQ(on.text(0), "\u28FF");
}

TEST(Canvas, WordsHideDots_AndPointsHideTheGrid) {
  canvas on(3, 1, glyphs::braille);
  on.dot(0, 0, ink::grid);
  EXPECT_EQ(on.at(0, 0), (canvas_cell{0x2801, ink::grid}));
  on.dot(1, 3, ink::points);
  EXPECT_EQ(on.at(0, 0), (canvas_cell{0x2880, ink::points}));
  on.write(0, 0, "a", ink::warn);
  EXPECT_EQ(on.at(0, 0), (canvas_cell{U'a', ink::warn}));
  EXPECT_EQ(on.at(1, 0), canvas_cell{});
  on.write(1, 0, "\xC3\xA9\x1B", ink::plain);  // nothing that a terminal would obey
  EXPECT_EQ(on.text(0), "a??");
}

TEST(Canvas, InAscii_HasTwoDotsPerCell) {
  canvas on(2, 2, glyphs::ascii);
  on.dot(0, 1, ink::grid);
  on.dot(1, 2, ink::points);
  EXPECT_EQ(on.text(0), ".");
  EXPECT_EQ(on.text(1), " *");
}

TEST(Canvas, WhatIsOutside_IsIgnored) {
  canvas on(2, 1, glyphs::braille);
  for (const int far : {-1, 4, 1000}) {
    on.dot(far, 0, ink::points);
    on.dot(0, far, ink::points);
    on.write(far, 0, "x", ink::plain);
    on.write(0, far, "x", ink::plain);
  }
  on.write(0, 0, "abc", ink::plain, {0, 0, 1, 1});
  EXPECT_EQ(on.text(0), "a");
  EXPECT_EQ(canvas(0, 0, glyphs::ascii).at(0, 0), canvas_cell{});
}

// 5 x 3 cells are 10 x 12 dots: the middle is at 4.5 and 5.5, and a metre has 4.5 dots.
TEST(Radar, ShowsAPointWhereItIs) {
  const std::vector<point> ahead{at(180.0F, 1.0F)};  // at 5, 1
  const std::vector<point> left{at(90.0F, 1.0F)};    // at 0, 6; at 9, 6 in the vendor's frame
  const cell_area all{0, 0, 5, 3};
  radar_view view{.range_m = 1.0, .grid = false};
  {
    canvas on(5, 3, glyphs::braille);
    draw_radar(on, all, ahead, view);
    EXPECT_EQ(on.text(0), "  \u2810");
    EXPECT_EQ(on.text(1), "  +");
    EXPECT_EQ(on.text(2), "");
  }
  {
    canvas on(5, 3, glyphs::braille);
    draw_radar(on, all, left, view);
    EXPECT_EQ(on.text(1), "\u2804 +");
  }
  view.frame = g4lidar::frame::vendor;
  canvas on(5, 3, glyphs::braille);
  draw_radar(on, all, left, view);
  EXPECT_EQ(on.text(1), "  + \u2820");
}

TEST(Radar, OutsideOfItsArea_DrawsNothing) {
  canvas on(20, 3, glyphs::braille);
  draw_radar(on, {0, 0, 5, 3}, std::vector<point>{at(270.0F, 3.0F)}, {.range_m = 1.0});
  for (int row = 0; row < 3; ++row) {
    for (int column = 5; column < 20; ++column) EXPECT_EQ(on.at(column, row), canvas_cell{});
  }
}

// 21 x 11 cells in ASCII are 21 x 22 dots: 10 dots for 2 m, so the ring of 1 m is 5 dots from the middle.
TEST(Radar, HasRingsWithTheirRanges) {
  canvas on(21, 11, glyphs::ascii);
  draw_radar(on, {0, 0, 21, 11}, {}, {.range_m = 2.0});
  EXPECT_EQ(on.at(5, 5).what, ink::grid);
  EXPECT_EQ(on.at(15, 5).what, ink::grid);
  EXPECT_EQ(on.text(3).substr(11, 3), "1 m");  // the ring's highest dot is at 10.5 - 5, in row 3
  EXPECT_EQ(on.at(10, 0), (canvas_cell{U'^', ink::title}));
}

TEST(Radar, RangeFollowsNearlyAllReturns) {
  std::vector<point> points(100, at(10.0F, 2.5F));
  EXPECT_EQ(range_for(points), 3.0);
  points[0] = points[1] = at(10.0F, 15.0F);
  EXPECT_EQ(range_for(points), 3.0);
  for (int i = 0; i < 10; ++i) points[static_cast<std::size_t>(i)] = at(10.0F, 15.0F);
  EXPECT_EQ(range_for(points), 16.0);
  EXPECT_EQ(range_for({}), 16.0);
  EXPECT_EQ(next_range(3.0, true), 4.0);
  EXPECT_EQ(next_range(3.0, false), 2.0);
  EXPECT_EQ(next_range(16.0, true), 24.0);
  EXPECT_EQ(next_range(50.0, true), 50.0);
  EXPECT_EQ(next_range(0.5, false), 0.5);
}

// A TG15 measures up to 30 m, and a TG50 up to 50 m (family.md).
TEST(Radar, RangeFollowsReturnsThatAreFarther) {
  EXPECT_EQ(range_for(std::vector<point>(100, at(10.0F, 29.0F))), 32.0);
  EXPECT_EQ(range_for(std::vector<point>(100, at(10.0F, 49.5F))), 50.0);
  canvas on(21, 11, glyphs::ascii);
  draw_radar(on, {0, 0, 21, 11}, {}, {.range_m = 32.0});  // 10 dots for 32 m: rings of 8 m
  EXPECT_EQ(on.text(3).substr(11, 4), "16 m");
}

TEST(Picture, HasTheIntensities_OfModelsThatMeasureThem) {
  const auto has = [](const view_facts& facts, std::string_view words) {
    canvas on(80, 24, glyphs::ascii);
    draw_view(on, {}, facts, {});
    for (int row = 0; row < on.rows(); ++row) {
      if (on.text(row).find(words) != std::string::npos) return true;
    }
    return false;
  };
  EXPECT_TRUE(has({.intensity = std::pair(12, 1023)}, "intensity 12 to 1023"));
  EXPECT_FALSE(has({}, "intensity"));
}

// The wall is 3 m from where the robot begins, which turns to the left after 1 m.
TEST(Trails, StayWhereTheWallsAre) {
  const std::vector<point> first{at(180.0F, 3.0F)};
  const std::vector<point> second{
      at(270.0F, 2.0F)};  // it looks to the left: the wall is to the right
  trails shown;
  shown.change_length();
  shown.add({.points = first}, lidar_place{{0, 0, 0}, 1});
  shown.add({.points = second}, lidar_place{{1, 0, 1.5707963267948966}, 1});
  radar_view view{.range_m = 8.0};
  const auto has = [&view](float x_m, float y_m) {
    return std::ranges::any_of(view.traces, [&](const g4lidar::xy_point& each) {
      return std::abs(each.x_m - x_m) < 1e-5F && std::abs(each.y_m - y_m) < 1e-5F;
    });
  };
  shown.show(view, false);
  EXPECT_FALSE(view.is_map);
  EXPECT_EQ(view.robot, g4lidar::pose_2d{});
  EXPECT_TRUE(has(0.0F, -2.0F)) << "the wall, of both revolutions";
  EXPECT_TRUE(has(0.0F, 1.0F)) << "where the robot began";
  shown.show(view, true);
  EXPECT_TRUE(view.is_map);
  EXPECT_NEAR(view.robot.x_m, 1.0, 1e-9);
  EXPECT_NEAR(view.robot.yaw_rad, 1.5707963, 1e-6);
  EXPECT_TRUE(has(3.0F, 0.0F));
  EXPECT_TRUE(has(0.0F, 0.0F));
  // In another map nothing of this one has a place.
  shown.add({.points = first}, lidar_place{{5, 5, 0}, 2});
  shown.show(view, true);
  EXPECT_EQ(view.traces.size(), 2U) << "where it begins, and the return";
  shown.add({.points = first}, std::nullopt);
  shown.show(view, true);
  EXPECT_FALSE(view.is_map);
  EXPECT_TRUE(view.traces.empty());
}

// 5 x 3 cells are 10 x 12 dots: the middle is at 4.5 and 5.5, and a metre has 4.5 dots.
TEST(Radar, InTheMap_ARobotHasAPlaceAndADirection) {
  canvas on(5, 3, glyphs::braille);
  const radar_view view{
      .range_m = 1.0, .grid = false, .is_map = true, .robot = {-0.8, 0.8, -1.5707963267948966}};
  draw_radar(on, {0, 0, 5, 3}, std::vector<point>{at(180.0F, 1.6F)}, view);
  EXPECT_EQ(on.at(0, 2).glyph, U'+');            // at the left and at the bottom
  EXPECT_EQ(on.text(2).substr(1), "   \u2802");  // it looks to the right: the dot is at 8.1 and 9.1
}

view_facts facts() {
  view_facts known{.name = "sim:", .state = "running", .serial = "2021101000070073"};
  known.frequency_hz = 7.0;
  known.lost_percent = 1.5;
  known.stages.push_back({.stage = g4lidar::diagnostic_stage::loss});
  return known;
}

TEST(Picture, OfAnySize_IsDrawn) {
  const std::vector<point> points{at(180.0F, 1.0F), at(20.0F, 3.0F)};
  for (const int columns : {0, 1, 2, 5, 20, 59, 60, 80, 300}) {
    for (const int rows : {0, 1, 2, 3, 11, 12, 24, 100}) {
      for (const bool helps : {false, true}) {
        canvas on(columns, rows, glyphs::braille);
        draw_view(on, points, facts(), {.shows_help = helps});
      }
    }
  }
}

TEST(Picture, HasTheFactsBesideTheRadar) {
  view_facts known = facts();
  canvas on(80, 24, glyphs::ascii);
  draw_view(on, {}, known, {});
  EXPECT_EQ(on.text(0).substr(54), "sim:");
  EXPECT_EQ(on.text(1).substr(54), "state     running");
  EXPECT_EQ(on.text(3).substr(54), "frequency 7.00 Hz");
  EXPECT_EQ(on.text(6).substr(54), "lost      1.50 %");
  EXPECT_EQ(on.text(14).substr(54), "ok");
  known.stages[0].find(g4lidar::diagnosis::bits_flipped);
  canvas bad(80, 24, glyphs::ascii);
  draw_view(bad, {}, known, {.is_frozen = true});
  EXPECT_EQ(bad.text(1).substr(54), "state     running, frozen");
  EXPECT_EQ(bad.text(14).substr(54), "bits_flipped");
  EXPECT_EQ(bad.at(54, 14).what, ink::bad);
}

TEST(Picture, WithLittleRoom_HasOneLine) {
  canvas on(40, 6, glyphs::ascii);
  draw_view(on, {}, facts(), {});
  EXPECT_EQ(on.text(5), "running 7.00 Hz - lost 1.50% doctor ok");
}

}  // namespace
class MergedView : public cli::scratch {};

TEST_F(MergedView, OneThatCannotBeOpened_IsNamed_AndTheOtherIsShown) {
  const auto shown = cli::run(
      {"view", "--once", "front=tcp:127.0.0.1:9", "rear=sim:", "--merge", "--size", "50x18"});
  EXPECT_EQ(shown.code, 0) << shown.err;
  EXPECT_EQ(cli::lines_of(shown.out).size(), 18U);
  EXPECT_NE(shown.err.find("127.0.0.1:9"), std::string::npos) << shown.err;
}

// Each sees a wall of its own, ahead of the robot and behind it.
TEST_F(MergedView, ShowsTheReturnsOfBothLidars) {
  cli::write_file(path("front.txt"), "wall -1 2 1 2\nlidar 0 0 -90\n");
  cli::write_file(path("rear.txt"), "wall -1 -2 1 -2\nlidar 0 0 -90\n");
  const std::string front = "front=sim:?world=" + path("front.txt");
  const std::string rear = "rear=sim:?world=" + path("rear.txt");
  const auto shown =
      cli::run({"view", "--once", front, rear, "--merge", "--glyphs", "ascii", "--size", "50x18"});
  EXPECT_EQ(shown.code, 0) << shown.err;
  const std::vector<std::string> rows = cli::lines_of(shown.out);
  ASSERT_EQ(rows.size(), 18U);
  const auto has_returns = [](const std::string& row) {
    return row.find('*') != std::string::npos;
  };
  EXPECT_TRUE(std::any_of(rows.begin(), rows.begin() + 7, has_returns)) << shown.out;
  EXPECT_TRUE(std::any_of(rows.begin() + 9, rows.end(), has_returns)) << shown.out;
  const auto refused = cli::run({"view", "--once", front, rear});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("add --merge"), std::string::npos) << refused.err;
}

}  // namespace g4_tool
