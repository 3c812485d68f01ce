// SPDX-License-Identifier: MIT
// Worlds from text: valid ones, and the errors of invalid ones, with the line.
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <variant>

#include "g4lidar/sim/random.hpp"
#include "g4lidar/sim/world.hpp"

namespace {

using namespace g4lidar;

// The world, or a test failure with the error.
sim::world good(std::string_view text) {
  auto read = sim::parse_world(text);
  if (const auto* error = std::get_if<sim::world_error>(&read)) {
    ADD_FAILURE() << "line " << error->line << ": " << error->message;
    return {};
  }
  return std::get<sim::world>(std::move(read));
}

struct refusal {
  const char* name;
  std::string_view text;
  std::size_t line;
  std::string_view message;
};

void PrintTo(const refusal& r, std::ostream* out) { *out << r.name; }

class SimWorldRefuses : public testing::TestWithParam<refusal> {};

TEST_P(SimWorldRefuses, WithTheLineAndAReason) {
  const auto read = sim::parse_world(GetParam().text);
  const auto* error = std::get_if<sim::world_error>(&read);
  ASSERT_NE(error, nullptr);
  EXPECT_EQ(error->line, GetParam().line);
  EXPECT_NE(error->message.find(GetParam().message), std::string::npos) << error->message;
}

using namespace std::string_view_literals;

INSTANTIATE_TEST_SUITE_P(
    Text, SimWorldRefuses,
    testing::Values(
        refusal{"nothing", "", 0, "there is no line 'lidar x y heading_deg'"},
        refusal{"no_lidar", "wall 1 0 1 1\n", 0, "there is no line 'lidar"},
        refusal{"two_lidars", "lidar 0 0 0\n\nlidar 1 1 0\n", 3, "second lidar"},
        refusal{"unknown_word", "lidar 0 0 0\nWall 1 0 1 1\n", 2, "'Wall' is unknown"},
        refusal{"unprintable_word", "\x01\xFF\x7F 1 2\n"sv, 1, "'?\?\?' is unknown"},
        refusal{"zero_byte", "lidar 0 0 0\0"sv, 1, "'0?' is not a number"},
        refusal{"long_word", "abcdefghijklmnopqrstuvwxyz", 1, "'abcdefghijklmnopqrstuvwx...'"},
        refusal{"too_few", "lidar 0 0 0\nwall 1 0 1", 2,
                "expected 'wall x1 y1 x2 y2', found 3 numbers"},
        refusal{"too_many", "lidar 0 0 0 0", 1, "expected 'lidar x y heading_deg', found 4"},
        refusal{"one", "wall 1", 1, "found 1 number"},
        refusal{"letter", "lidar 0 0 x", 1, "'x' is not a number"},
        refusal{"exponent", "lidar 0 1e3 0", 1, "'1e3' is not a number"},
        refusal{"infinity", "lidar 0 inf 0", 1, "'inf' is not a number"},
        refusal{"two_points", "lidar 0 1.2.3 0", 1, "'1.2.3' is not a number"},
        refusal{"comma", "lidar 0 1,5 0", 1, "'1,5' is not a number"},
        refusal{"sign_alone", "lidar - 0 0", 1, "'-' is not a number"},
        refusal{"point_alone", "lidar . 0 0", 1, "'.' is not a number"},
        refusal{"two_signs", "lidar +-1 0 0", 1, "'+-1' is not a number"},
        refusal{"digits", "lidar 0.1234567890123456 0 0", 1, "up to 15 digits"},
        refusal{"decimals", "lidar 0.0000000000000001 0 0", 1, "up to 15 digits"},
        refusal{"huge", "lidar 99999999999999999999999999 0 0", 1, "is not a number"},
        refusal{"far_wall", "lidar 0 0 0\nwall 1 0 1000.1 1", 2, "beyond 1000 m"},
        refusal{"far_lidar", "lidar 0 -1000.1 0", 1, "beyond 1000 m"},
        refusal{"heading", "lidar 0 0 360.5", 1, "-360 to 360"},
        refusal{"no_length", "lidar 0 0 0\nwall 1 1 1 1.0005", 2, "shorter than 1 mm"},
        refusal{"at_the_lidar", "lidar 1 1 0\nwall 5 5 6 6\nwall 0 1 2 1.01", 3, "within 1 cm"},
        refusal{"disc_form", "lidar 0 0 0\ndisc 1 1 1 2", 2, "disc radius x y to_x to_y speed"},
        refusal{"disc_size", "lidar 0 0 0\ndisc 2.1 5 5", 2, "radius must be 0.01 to 2 m"},
        refusal{"disc_speed", "disc 1 5 5 6 6 -1", 1, "speed must be 0 to 10 m/s"},
        refusal{"far_disc", "disc 1 5 1001", 1, "beyond 1000 m"},
        refusal{"two_mounts", "mount 0,0,0\nmount 0,0,0", 2, "second line 'mount'"},
        refusal{"far_mount", "mount 0,-1001,0", 1, "beyond 1000 m"},
        refusal{"mount_form", "mount 0,0", 1, "expected 'mount X,Y,DEG', found 2 numbers"},
        refusal{"mount_number", "mount 0,0,x", 1, "'x' is not a number"},
        refusal{"mount_with_blanks", "mount 0, 0, 0", 1, "without blanks"},
        refusal{"mount_top_down", "mount 0,0,0,down", 1, "cannot be mounted top down"},
        refusal{"old_mount", "mount 0 0 180", 1, "as for --mount: write 'mount 0,0,0'"},
        refusal{"old_turned_mount", "lidar 0 0 0\nmount 0.2 -0.05 -30.5", 2,
                "direction of the cable. It is now where the lidar looks, as for --mount: write "
                "'mount 0.2,-0.05,149.5'"},
        refusal{"no_mount", "mount", 1, "expected 'mount X,Y,DEG', found 0 numbers"},
        refusal{"wall_at_the_mount", "lidar 0 0 0\nmount 1,0,0\nwall 1 1 1 -1", 3, "within 1 cm"},
        refusal{"wall_at_the_first_pose", "wall 1 1 1 -1\npose 0 1 0 0", 1, "within 1 cm"},
        refusal{"drive_without_lidar", "drive wait 1", 0, "there is no line 'lidar"},
        refusal{"pose_form", "pose 0 0 0", 1, "expected 'pose time x y heading_deg', found 3"},
        refusal{"pose_nan", "pose 0 nan 0 0", 1, "'nan' is not a number"},
        refusal{"pose_before_zero", "pose -1 0 0 0", 1, "time must be 0 to 1000000 s"},
        refusal{"pose_heading", "pose 0 0 0 361", 1, "-360 to 360"},
        refusal{"far_pose", "pose 0 1001 0 0", 1, "beyond 1000 m"},
        refusal{"time_stands", "pose 1 0 0 0\npose 1 0 0 0", 2, "not later"},
        refusal{"time_falls", "pose 1 0 0 0\n\npose 0.9 0 0 0", 3, "not later"},
        refusal{"jump", "pose 1 0 0 0\npose 2 20.1 0 0", 2, "more than 20 m/s"},
        refusal{"whirl", "pose 1 0 0 0\npose 1.1 0 0 101", 2, "more than 1000 degrees"},
        refusal{"both", "pose 1 0 0 0\ndrive wait 1", 2, "not both"},
        refusal{"both_reversed", "lidar 0 0 0\ndrive wait 1\npose 1 0 0 0", 3, "not both"},
        refusal{"unknown_command", "drive left 90", 1, "'left' is unknown; commands are"},
        refusal{"no_command", "drive", 1, "'' is unknown; commands are"},
        refusal{"command_form", "drive arc 1", 1, "expected 'drive arc radius degrees"},
        refusal{"far_forward", "drive forward 2001", 1, "a way must be"},
        refusal{"no_forward", "drive forward 0", 1, "a way must be"},
        refusal{"forward_speed", "drive forward 1 20.1", 1, "moves at 0.01 to 20 m/s"},
        refusal{"no_turn", "drive turn 0.01", 1, "a turn must be"},
        refusal{"turn_speed", "drive turn 90 0", 1, "turns at 1 to 1000"},
        refusal{"arc_radius", "drive arc 0 90", 1, "radius must be"},
        refusal{"arc_speed", "drive arc 0.05 90 1", 1, "turn at more than 1000"},
        refusal{"endless_wait", "drive wait 100001", 1, "a wait must be"},
        refusal{"leaves", "lidar 0 0 0\ndrive forward 999\ndrive forward 2", 3, "leave the world"},
        refusal{"behind_a_comment", "# a\n# b\nlidar 0 0\n", 3, "found 2 numbers"}),
    [](const auto& case_) { return std::string(case_.param.name); });

TEST(SimWorld, ReadsWallsAndTheLidar) {
  const sim::world world = good(
      "# a corner\n"
      "\n"
      "wall -1.5 2 +3.25 .5   # with a comment\n"
      "  lidar\t0.5 0 -90\r\n"
      "wall 1 1. 2 -0");
  ASSERT_EQ(world.walls.size(), 2U);
  EXPECT_EQ(world.walls[0].x1_m, -1.5);
  EXPECT_EQ(world.walls[0].y1_m, 2.0);
  EXPECT_EQ(world.walls[0].x2_m, 3.25);
  EXPECT_EQ(world.walls[0].y2_m, 0.5);
  EXPECT_EQ(world.walls[1].y1_m, 1.0);
  EXPECT_EQ(world.lidar.x_m, 0.5);
  EXPECT_EQ(world.lidar.y_m, 0.0);
  EXPECT_EQ(world.lidar.heading_deg, -90.0);
}

TEST(SimWorld, ReadsNumbersAsTheCompilerDoes) {
  const sim::world world = good("lidar 0.1 123.456789 359.999999999999\nwall 0.3 0.7 1.1 -2.675");
  EXPECT_EQ(world.lidar.x_m, 0.1);
  EXPECT_EQ(world.lidar.y_m, 123.456789);
  EXPECT_EQ(world.lidar.heading_deg, 359.999999999999);
  EXPECT_EQ(world.walls.at(0).x1_m, 0.3);
  EXPECT_EQ(world.walls.at(0).y1_m, 0.7);
  EXPECT_EQ(world.walls.at(0).x2_m, 1.1);
  EXPECT_EQ(world.walls.at(0).y2_m, -2.675);
}

TEST(SimWorld, WorldWithoutWalls_IsAccepted) { EXPECT_TRUE(good("lidar 0 0 0").walls.empty()); }

TEST(SimWorld, MoreThanTenThousandWalls_AreRefused) {
  std::string text = "lidar 0 0 0\n";
  for (std::size_t i = 0; i < sim::max_walls; ++i) text += "wall 1 1 2 2\n";
  EXPECT_EQ(good(text).walls.size(), sim::max_walls);
  const auto read = sim::parse_world(text + "wall 1 1 2 2\n");
  const auto* error = std::get_if<sim::world_error>(&read);
  ASSERT_NE(error, nullptr);
  EXPECT_EQ(error->line, sim::max_walls + 2);
}

TEST(SimWorld, ReadsDiscsMountAndPath) {
  const sim::world world = good(
      "disc 0.5 1 2\n"
      "disc 0.25 1 2 3 4 1.5\n"
      "mount 0.1,-0.2,90\n"
      "pose 1.5 3 4 -90\n"
      "pose 2 3 4.5 -100\n");
  ASSERT_EQ(world.discs.size(), 2U);
  EXPECT_EQ(world.discs[0].radius_m, 0.5);
  EXPECT_EQ(world.discs[0].speed_m_per_s, 0.0);
  EXPECT_EQ(world.discs[1].to_x_m, 3.0);
  EXPECT_EQ(world.discs[1].to_y_m, 4.0);
  EXPECT_EQ(world.discs[1].speed_m_per_s, 1.5);
  EXPECT_EQ(world.mounted_at, (sim::pose{0.1, -0.2, 90.0}));
  EXPECT_EQ(world.lidar, (sim::pose{3.0, 4.0, -90.0}));
  ASSERT_EQ(world.path.size(), 2U);
  EXPECT_EQ(world.path[1].time_ns, 2'000'000'000);
  EXPECT_EQ(world.path[1].robot.at, (sim::pose{3.0, 4.5, -100.0}));
}

TEST(SimWorld, HugeCounts_AreRefused) {
  const auto line_of_error = [](const std::string& text) {
    const auto read = sim::parse_world(text);
    const auto* error = std::get_if<sim::world_error>(&read);
    return error != nullptr ? error->line : 0;
  };
  std::string discs = "lidar 0 0 0\n";
  for (int i = 0; i < 1001; ++i) discs += "disc 1 5 5\n";
  EXPECT_EQ(line_of_error(discs), 1002U);
  std::string poses;
  for (int i = 0; i < 100'001; ++i) poses += "pose " + std::to_string(i) + " 0 0 0\n";
  EXPECT_EQ(line_of_error(poses), 100'001U);
  std::string arcs = "lidar 0 0 0\n";
  for (int i = 0; i < 1000; ++i) arcs += "drive arc 1 3600 10\n";
  EXPECT_GT(line_of_error(arcs), 50U);
  std::string waits = "lidar 0 0 0\n";
  for (int i = 0; i < 11; ++i) waits += "drive wait 100000\n";
  EXPECT_EQ(line_of_error(waits), 12U);
}

TEST(SimPath, APathFileHasPosesOrCommandsAlone) {
  const auto error_of = [](std::string_view text) {
    const auto read = sim::parse_path(text, {});
    const auto* error = std::get_if<sim::world_error>(&read);
    return error != nullptr ? std::to_string(error->line) + " " + error->message : "";
  };
  EXPECT_EQ(error_of("# here\ndrive wait 1\n"), "");
  EXPECT_EQ(error_of(""), "0 there is no line 'pose' and no line 'drive'");
  EXPECT_EQ(error_of("\nwall 1 1 2 2\n"),
            "2 'wall' is unknown; a line of a path begins with 'pose', 'drive' or '#'");
}

TEST(SimWorld, AnyBytesAreAWorldOrAnError) {
  constexpr std::string_view letters =
      "wall lidar disc pose drive turn arc wait 0123456789.-+#\n\n\t\r\xFF";
  sim::random_stream random(7);
  for (int i = 0; i < 20'000; ++i) {
    std::string text = i % 2 == 0 ? "lidar 0 0 0\n" : "";
    for (std::uint64_t n = random.next() % 80; n > 0; --n) {
      text += i % 4 < 2 ? letters[random.next() % letters.size()]
                        : static_cast<char>(random.next() & 0xFFU);
    }
    const auto read = sim::parse_world(text);
    const auto* error = std::get_if<sim::world_error>(&read);
    if (error != nullptr) {
      EXPECT_FALSE(error->message.empty());
    }
  }
}

TEST(SimWorld, BuiltInWorld_MeetsTheRulesOfAFile) {
  const sim::world world = sim::built_in_world();
  std::string text = "lidar " + std::to_string(world.lidar.x_m) + " " +
                     std::to_string(world.lidar.y_m) + " " +
                     std::to_string(world.lidar.heading_deg) + "\n";
  for (const sim::wall& w : world.walls) {
    text += "wall " + std::to_string(w.x1_m) + " " + std::to_string(w.y1_m) + " " +
            std::to_string(w.x2_m) + " " + std::to_string(w.y2_m) + "\n";
  }
  const sim::world read = good(text);
  ASSERT_EQ(read.walls.size(), world.walls.size());
  for (std::size_t i = 0; i < read.walls.size(); ++i) {
    EXPECT_EQ(read.walls[i].x1_m, world.walls[i].x1_m);
    EXPECT_EQ(read.walls[i].y1_m, world.walls[i].y1_m);
    EXPECT_EQ(read.walls[i].x2_m, world.walls[i].x2_m);
    EXPECT_EQ(read.walls[i].y2_m, world.walls[i].y2_m);
  }
}

}  // namespace
