// SPDX-License-Identifier: MIT
// Scans that are filtered, marked and deskewed in C, with points made by hand.
#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include "c_handles.hpp"

namespace {

using namespace g4lidar_c_test;

class CFilter : public testing::Test {
 protected:
  CFilter() { g4lidar_filter_options_init(&options_, sizeof options_); }
  /// The result of making a shaper by the filter, and of shaping the points.
  int shape() {
    g4lidar_shaper_options options = shaper_defaults();
    options.filter = &options_;
    g4lidar_shaper* made = nullptr;
    const int done = g4lidar_shaper_create(&options, &made, nullptr);
    shaper_.reset(made);
    return done == G4LIDAR_OK
               ? g4lidar_shaper_shape(made, points_.data(), points_.size(), false, nullptr, 0)
               : done;
  }
  /// The indices of the points that are kept.
  std::vector<std::size_t> kept() {
    EXPECT_EQ(shape(), G4LIDAR_OK);
    std::vector<std::size_t> indices;
    for (const g4lidar_point& each : kept_by(shaper_)) {
      indices.push_back(static_cast<std::size_t>(each.time_ns));
    }
    return indices;
  }

  std::vector<g4lidar_point> points_{at(0.0F, 1000.0F, 0), at(90.0F, 2000.0F, 1),
                                     at(180.0F, 0.0F, 2), at(270.0F, 50.0F, 3)};
  g4lidar_filter_options options_;
  shaper shaper_;
};
using indices = std::vector<std::size_t>;

TEST_F(CFilter, KeepsEverythingByDefault) { EXPECT_EQ(kept(), (indices{0, 1, 2, 3})); }

TEST_F(CFilter, ByEachCondition) {
  options_.least_range_mm = 100.0F;
  EXPECT_EQ(kept(), (indices{0, 1}));
  options_.greatest_range_mm = 1500.0F;
  EXPECT_EQ(kept(), indices{0});
  g4lidar_filter_options_init(&options_, sizeof options_);
  options_.returns_only = true;
  EXPECT_EQ(kept(), (indices{0, 1, 3}));
  options_.trusted_only = true;
  EXPECT_EQ(kept(), (indices{0, 1}));
  g4lidar_filter_options_init(&options_, sizeof options_);
  options_.excluded_flags = G4LIDAR_TOO_NEAR;
  EXPECT_EQ(kept(), (indices{0, 1, 2}));
  g4lidar_filter_options_init(&options_, sizeof options_);
  options_.field_of_view = {80.0, 190.0};
  EXPECT_EQ(kept(), (indices{1, 2}));
  const g4lidar_sector ignored[2] = {{350.0, 10.0}, {260.0, 280.0}};
  g4lidar_filter_options_init(&options_, sizeof options_);
  options_.ignored_sectors = ignored;
  options_.ignored_sector_count = 2;
  EXPECT_EQ(kept(), (indices{1, 2}));
  options_.frame = G4LIDAR_ROBOT;  // 0 is ahead, at 180 degrees of the device
  EXPECT_EQ(kept(), (indices{0, 1}));
}

TEST_F(CFilter, ByMasks) {
  g4lidar_mask* mask = nullptr;
  g4lidar_error why;
  // Behind the robot, around the point at 0 degrees of the device.
  ASSERT_EQ(
      g4lidar_mask_parse("# a mast\npolygon -1.1 -0.1 -0.9 -0.1 -0.9 0.1 -1.1 0.1\n", &mask, &why),
      G4LIDAR_OK)
      << why.message;
  options_.masks = g4lidar_mask_polygons(mask, &options_.mask_count);
  ASSERT_EQ(options_.mask_count, 1U);
  EXPECT_EQ(options_.masks[0].count, 4U);
  EXPECT_EQ(options_.masks[0].corners[2].y_m, 0.1F);
  EXPECT_EQ(kept(), (indices{1, 2, 3}));
  g4lidar_mask_free(mask);
  EXPECT_EQ(g4lidar_mask_parse("\npolygon 1 2\n", &mask, &why), G4LIDAR_BAD_FILE);
  EXPECT_EQ(mask, nullptr);
  EXPECT_EQ(std::strncmp(why.message, "line 2: ", 8), 0) << why.message;
}

TEST_F(CFilter, ForAGridMarksWhatItLeavesOut) {
  options_.least_range_mm = 1500.0F;
  ASSERT_EQ(shape(), G4LIDAR_OK);
  std::size_t count = 0;
  const g4lidar_point* const out = g4lidar_shaper_for_grid(shaper_.get(), &count);
  ASSERT_EQ(count, 4U);
  EXPECT_EQ(out[0].flags, G4LIDAR_TOO_NEAR);
  EXPECT_EQ(out[1].flags, 0);
  EXPECT_EQ(out[2].flags, G4LIDAR_NO_RETURN);
}

TEST_F(CFilter, RefusesImpossibleOptions) {
  options_.mask_count = 1;
  EXPECT_EQ(shape(), G4LIDAR_BAD_ARGUMENT);
  g4lidar_filter_options_init(&options_, sizeof options_);
  options_.ignored_sector_count = 1;
  EXPECT_EQ(shape(), G4LIDAR_BAD_ARGUMENT);
  g4lidar_filter_options_init(&options_, sizeof options_);
  options_.frame = 5;
  EXPECT_EQ(shape(), G4LIDAR_BAD_ARGUMENT);
}

TEST(CShaper, ShapesTheScansOfItsModel) {
  // A T-mini looks at its 0 degrees, and does not correct angles: 90 degrees without return are the beam of before.
  std::vector<g4lidar_point> points{at(90.0F, 400.0F), at(90.0F, 0.0F), at(0.0F, 1000.0F)};
  points[1].revolution = points[2].revolution = 1;
  const g4lidar_sector ahead{-10.0, 10.0};
  g4lidar_near_options limits;
  g4lidar_near_options_init(&limits, sizeof limits);
  limits.shortest_mm = 280.0F;
  g4lidar_filter_options filter;
  g4lidar_filter_options_init(&filter, sizeof filter);
  filter.frame = G4LIDAR_ROBOT;
  filter.ignored_sectors = &ahead;
  filter.ignored_sector_count = 1;
  g4lidar_shaper_options options = shaper_defaults();
  EXPECT_EQ(options.model, nullptr);
  options.near_options = &limits;
  options.filter = &filter;
  const auto flags = [&](const char* model) {
    options.model = model;
    const shaper made = make(options);
    EXPECT_EQ(g4lidar_shaper_shape(made.get(), points.data(), 3, false, nullptr, 0), G4LIDAR_OK);
    std::vector<int> all;
    for (const g4lidar_point& each : kept_by(made)) all.push_back(each.flags);
    return all;
  };
  EXPECT_EQ(flags("t-mini-pro"),
            (std::vector<int>{0, G4LIDAR_NO_RETURN | G4LIDAR_MAY_BE_TOO_NEAR}));
  EXPECT_EQ(flags("g4"), (std::vector<int>{0, G4LIDAR_NO_RETURN, 0}));
  EXPECT_EQ(flags(nullptr), flags("g4"));
  options.model = "g44";
  g4lidar_shaper* none = nullptr;
  EXPECT_EQ(g4lidar_shaper_create(&options, &none, nullptr), G4LIDAR_BAD_ARGUMENT);
  limits.shortest_mm = 100.0F;
  EXPECT_EQ(flags("t-mini-pro"), (std::vector<int>{0, G4LIDAR_NO_RETURN})) << "400 mm is not near";
  limits.shortest_mm = -1.0F;
  EXPECT_EQ(g4lidar_shaper_create(&options, &none, nullptr), G4LIDAR_BAD_ARGUMENT);
}

TEST(CShaper, LeavesOutReturnsBetweenSurfaces_AndFlagsThemForGrids) {
  // A wall 4 m away; one return in the air; later a return between 2 m and 4 m.
  std::vector<g4lidar_point> points;
  for (int i = 0; i < 100; ++i) {
    points.push_back(at(static_cast<float>(i) * 0.28F, i < 60 ? 4000.0F : 2000.0F));
  }
  points[20].range_mm = 1000.0F;
  points[60].range_mm = 3000.0F;
  g4lidar_outlier_options limits;
  g4lidar_outlier_options_init(&limits, sizeof limits);
  const auto kept = [&](bool speckle, bool edges) {
    g4lidar_shaper_options options = shaper_defaults();
    if (speckle) options.speckle = &limits;
    if (edges) options.edges = &limits;
    return shaped(options, points).size();
  };
  EXPECT_EQ(kept(true, false), 98U);
  EXPECT_EQ(kept(false, true), 99U);
  EXPECT_EQ(kept(true, true), 98U);
  g4lidar_shaper_options options = shaper_defaults();
  options.speckle = options.edges = &limits;
  const shaper made = make(options);
  ASSERT_EQ(g4lidar_shaper_shape(made.get(), points.data(), 100, true, nullptr, 0), G4LIDAR_OK);
  std::size_t count = 0;
  const g4lidar_point* const all = g4lidar_shaper_for_grid(made.get(), &count);
  ASSERT_EQ(count, 100U);
  EXPECT_EQ(all[20].flags, G4LIDAR_ISOLATED | G4LIDAR_TOO_NEAR);
  EXPECT_EQ(all[60].flags, G4LIDAR_ISOLATED | G4LIDAR_VEILING | G4LIDAR_TOO_NEAR);
  g4lidar_shaper* none = nullptr;
  limits.window = 17;
  EXPECT_EQ(g4lidar_shaper_create(&options, &none, nullptr), G4LIDAR_BAD_ARGUMENT);
  limits.window = 1;
  limits.least_angle_deg = 50.0F;
  EXPECT_EQ(g4lidar_shaper_create(&options, &none, nullptr), G4LIDAR_BAD_ARGUMENT);
}

TEST(CShaper, DeskewsByThePath_AndFlagsAndCountsTheRest) {
  constexpr std::int64_t second_ns = 1'000'000'000;
  // 1 m/s towards a wall straight ahead; the path ends before the last point.
  const std::vector<g4lidar_point> points{at(180.0F, 3000.0F, second_ns),
                                          at(180.0F, 2000.0F, 2 * second_ns),
                                          at(180.0F, 1000.0F, 3 * second_ns)};
  std::vector<g4lidar_stamped_pose> path{{second_ns, {0.0, 0.0, 0.0}},
                                         {2 * second_ns, {1.0, 0.0, 0.0}}};
  g4lidar_shaper_options options = shaper_defaults();
  options.deskew = G4LIDAR_DESKEW_BY_PATH;
  options.restamps = true;
  const shaper made = make(options);
  ASSERT_EQ(g4lidar_shaper_shape(made.get(), points.data(), 3, false, path.data(), 2), G4LIDAR_OK);
  const auto kept = kept_by(made);
  ASSERT_EQ(kept.size(), 3U);
  EXPECT_NEAR(kept[1].range_mm, 3000.0F, 0.02F);
  EXPECT_EQ(kept[1].time_ns, second_ns);
  EXPECT_EQ(kept[2].range_mm, 1000.0F);
  EXPECT_EQ(kept[2].time_ns, 3 * second_ns);
  EXPECT_EQ(kept[2].flags, G4LIDAR_NOT_DESKEWED);
  EXPECT_EQ(g4lidar_shaper_outside(made.get()), 1U);
  path[0].time_ns = 5 * second_ns;
  EXPECT_EQ(g4lidar_shaper_shape(made.get(), points.data(), 3, false, path.data(), 2),
            G4LIDAR_BAD_ARGUMENT);
  path[0] = {second_ns, {std::nan(""), 0.0, 0.0}};
  EXPECT_EQ(g4lidar_shaper_shape(made.get(), points.data(), 3, false, path.data(), 1),
            G4LIDAR_BAD_ARGUMENT);
  options.deskew = 3;
  g4lidar_shaper* none = nullptr;
  EXPECT_EQ(g4lidar_shaper_create(&options, &none, nullptr), G4LIDAR_BAD_ARGUMENT);
}

constexpr std::int64_t second = 1'000'000'000;

/// 1 m/s ahead from second 1 to second 2.
constexpr g4lidar_stamped_pose ahead[2] = {{second, {0.0, 0.0, 0.0}},
                                           {2 * second, {1.0, 0.0, 0.0}}};

TEST(CShaper, DeskewsForItsMountingAndItsModel) {
  // At 2 s something is 2 m in front of the robot, and so 3 m at 1 s.
  g4lidar_shaper_options options = shaper_defaults();
  options.deskew = G4LIDAR_DESKEW_BY_PATH;
  const auto range_mm = [&](float angle_deg) {
    const std::vector<g4lidar_point> points{at(0.0F, 0.0F, second),
                                            at(angle_deg, 2000.0F, 2 * second)};
    return shaped(options, points, ahead).at(1).range_mm;
  };
  EXPECT_NEAR(range_mm(180.0F), 3000.0F, 0.02F);
  options.model = "t-mini-pro";  // its 0 degrees are ahead
  EXPECT_NEAR(range_mm(0.0F), 3000.0F, 0.02F);
  EXPECT_NEAR(range_mm(180.0F), 1000.0F, 0.02F);
  g4lidar_mounting back{};
  back.pose.yaw_rad = std::numbers::pi;
  options.mount = &back;
  EXPECT_NEAR(range_mm(180.0F), 3000.0F, 0.02F);
}

}  // namespace
