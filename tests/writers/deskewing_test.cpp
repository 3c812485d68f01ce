// SPDX-License-Identifier: MIT
// A shaping_writer that deskews: the wall of a corridor ahead of a robot that drives towards it.
#include <gmock/gmock.h>

#include <array>
#include <cstdint>
#include <memory>
#include <numbers>
#include <span>
#include <string_view>
#include <vector>

#include "export/shaping_writer.hpp"

namespace g4lidar::test {
namespace {

using namespace g4_tool;
using ::testing::ElementsAre;
using ::testing::FloatNear;

constexpr std::int64_t begin_ns = 7'000'000'000;
constexpr std::int64_t tenth_ns = 100'000'000;

/// What a writer is given.
struct heard {
  std::vector<point> points;
  std::vector<pose_2d> robot;
};

class listener final : public point_writer {
 public:
  listener(heard& into, bool scans) : into_(into), scans_(scans) {}
  [[nodiscard]] bool takes_scans() const noexcept override { return scans_; }
  void write_points(std::span<const point> points, text_sink&) override {
    into_.points.insert(into_.points.end(), points.begin(), points.end());
  }
  void write_scan(const scan_record& record, text_sink& out) override {
    into_.robot.push_back(record.robot);
    write_points(record.scan.points, out);
  }

 private:
  heard& into_;
  bool scans_;
};

point ahead(float range_mm, std::int64_t time_ns) {
  point p;
  p.angle_deg = 180.0F;  // the x axis of frame::robot
  p.range_mm = range_mm;
  p.time_ns = time_ns;
  return p;
}

class Deskewing : public ::testing::Test {
 protected:
  void write(writing_options options, bool scans = true) {
    callback_sink sink([](std::string_view) {});
    shaping_writer writer(std::make_unique<listener>(heard_, scans), options);
    EXPECT_EQ(writer.takes_scans(), scans || options.shape.deskew != deskewing::none);
    scan_record record;
    record.scan.points = points_;
    record.time_ns = begin_ns;
    writer.write_scan(record, sink);
    not_deskewed_ = writer.points_not_deskewed();
    off_path_ = writer.scans_off_path();
  }
  [[nodiscard]] std::vector<float> ranges() const {
    std::vector<float> all;
    for (const point& p : heard_.points) all.push_back(p.range_mm);
    return all;
  }

  // 1 m/s along x, towards a wall that is 5 m away at the first point.
  const std::array<stamped_pose, 2> path_{
      {{begin_ns - tenth_ns, {2.0, 1.0, 0.0}}, {begin_ns + 2 * tenth_ns, {2.3, 1.0, 0.0}}}};
  const std::array<point, 2> points_{ahead(5000.0F, begin_ns), ahead(4900.0F, begin_ns + tenth_ns)};
  heard heard_;
  std::uint64_t not_deskewed_ = 0;
  std::uint64_t off_path_ = 0;
};

TEST_F(Deskewing, ByPath_SeesTheWallFromTheFirstPlace) {
  write({.shape = {.deskew = deskewing::by_path}, .path = path_});
  EXPECT_THAT(ranges(), ElementsAre(FloatNear(5000.0F, 0.02F), FloatNear(5000.0F, 0.02F)));
  EXPECT_EQ(not_deskewed_, 0U);
  ASSERT_EQ(heard_.robot.size(), 1U);
  EXPECT_NEAR(heard_.robot[0].x_m, 2.1, 1e-9);
  EXPECT_NEAR(heard_.robot[0].y_m, 1.0, 1e-9);
}

TEST_F(Deskewing, ALidarThatLooksBack_SeesTheWallFromTheFirstPlace) {
  write({.shape = {.deskew = deskewing::by_path, .mount = {.pose = {0.0, 0.0, std::numbers::pi}}},
         .path = path_});
  EXPECT_THAT(ranges(), ElementsAre(FloatNear(5000.0F, 0.02F), FloatNear(4800.0F, 0.02F)));
}

TEST_F(Deskewing, WithoutIt_TheRobotIsOnThePathOfTheOdometry) {
  write({.path = path_});
  EXPECT_THAT(ranges(), ElementsAre(5000.0F, 4900.0F));
  ASSERT_EQ(heard_.robot.size(), 1U);
  EXPECT_NEAR(heard_.robot[0].x_m, 2.1, 1e-9);
}

TEST_F(Deskewing, RevolutionsOffThePath_AreLeftOutOnRequest) {
  const auto early = std::span(path_).first(1);
  write({.path = early});
  ASSERT_EQ(heard_.robot.size(), 1U);
  EXPECT_EQ(heard_.robot[0], pose_2d{});
  EXPECT_EQ(off_path_, 0U);
  write({.path = early, .on_path_only = true});
  EXPECT_EQ(heard_.robot.size(), 1U);
  EXPECT_EQ(off_path_, 1U);
  write({.path = path_, .on_path_only = true});
  EXPECT_EQ(heard_.robot.size(), 2U);
}

TEST_F(Deskewing, PointsArePassedOnWhereNoRevolutionsAreTaken) {
  write({.shape = {.deskew = deskewing::by_path}, .path = path_, .time = time_style::zero}, false);
  EXPECT_THAT(ranges(), ElementsAre(FloatNear(5000.0F, 0.02F), FloatNear(5000.0F, 0.02F)));
  ASSERT_EQ(heard_.points.size(), 2U);
  EXPECT_EQ(heard_.points[0].time_ns, 0);
  EXPECT_EQ(heard_.points[1].time_ns, tenth_ns);
}

TEST_F(Deskewing, FiltersSeeWhatWasMeasured) {
  write({.shape = {.filter = {.greatest_range_mm = 4950.0F}, .deskew = deskewing::by_path},
         .path = path_});
  EXPECT_THAT(ranges(), ElementsAre(FloatNear(5000.0F, 0.02F)));
}

TEST_F(Deskewing, OutsideOfThePath_PointsAreFlaggedAndCounted) {
  const std::array<stamped_pose, 2> short_path{
      {{begin_ns - tenth_ns, {}}, {begin_ns + tenth_ns / 2, {0.15, 0.0, 0.0}}}};
  write({.shape = {.deskew = deskewing::by_path}, .path = short_path});
  EXPECT_THAT(ranges(), ElementsAre(FloatNear(5000.0F, 0.02F), 4900.0F));
  EXPECT_EQ(not_deskewed_, 1U);
  EXPECT_EQ(heard_.points[0].flags, point_flags::none);
  EXPECT_EQ(heard_.points[1].flags, point_flags::not_deskewed);
}

TEST_F(Deskewing, ByScans_TheFirstRevolutionStaysAsItIs) {
  write({.shape = {.deskew = deskewing::by_scans}});
  EXPECT_THAT(ranges(), ElementsAre(5000.0F, 4900.0F));
  EXPECT_EQ(not_deskewed_, 2U);
  EXPECT_EQ(heard_.points[0].flags, point_flags::not_deskewed);
}

}  // namespace
}  // namespace g4lidar::test
