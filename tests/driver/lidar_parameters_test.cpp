// SPDX-License-Identifier: MIT
// Filters as parameters, on a scan that is written here.
#include "g4lidar/options/lidar_parameters.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "g4lidar/scan_shaper.hpp"

namespace g4lidar::test {
namespace {

using ::testing::HasSubstr;

TEST(LimitedRow, HasTheValuesOfTheModel) {
  const auto row = [](const char* name, const char* word) {
    return limits_of(*find_parameter(name), model_named(word));
  };
  const parameter_limits all = limits_of(*find_parameter("sample_rate"));
  EXPECT_EQ(all.constraints, "4000, 6000, 8000, 9000, 10000, 16000, 18000, 20000");
  EXPECT_EQ(row("sample_rate", "f4-pro").constraints, "4000, 6000");
  EXPECT_EQ(row("sample_rate", "g6").constraints, "8000, 16000, 18000");
  EXPECT_EQ(row("frequency", "tg15").range, (std::array{3.0, 16.0, 0.1}));
  EXPECT_EQ(row("frequency", "t-mini-pro").range, (std::array{6.0, 12.0, 0.1}));
  EXPECT_EQ(row("frequency", "x4").range, (std::array{0.0, 0.0, 0.0}));
  EXPECT_EQ(row("frequency", "x4").constraints,
            "this model does not have it; its speed: a voltage or PWM at its pin M_SCTR; most "
            "boards leave it at "
            "their default");
  EXPECT_EQ(row("range_max", "x4").range, (std::array{0.0, 100.0, 0.0}));
}

TEST(ConvertedValue, IsAsPeopleWriteIt) {
  using value = parameter_value;
  const std::int64_t nine = 9;
  const std::string fast = "fast";
  constexpr double infinite = std::numeric_limits<double>::infinity();
  struct row {
    value from;
    std::array<value, 4> to;  // a bool, an integer, a double, a string
  };
  const value none;
  for (const auto& [from, to] :
       std::vector<row>{{true, {true, none, none, std::string("on")}},
                        {nine, {none, nine, 9.0, none}},
                        {9.0, {none, nine, 9.0, none}},
                        {9.5, {none, none, 9.5, none}},
                        {1e18, {none, none, 1e18, none}},
                        {infinite, {none, none, infinite, std::string("inf")}},
                        {std::string("9"), {none, nine, 9.0, std::string("9")}},
                        {std::string("9.5"), {none, none, 9.5, std::string("9.5")}},
                        {std::string("false"), {false, none, none, std::string("off")}},
                        {std::string("on"), {true, none, none, std::string("on")}},
                        {fast, {none, none, none, fast}},
                        {std::string(), {none, none, none, std::string()}},
                        {none, {none, none, none, none}}}) {
    for (std::uint8_t type = 1; type <= to.size(); ++type)
      EXPECT_EQ(converted(from, type), to.at(type - 1U)) << from.index() << " to " << int{type};
  }
}

/// A lidar without filters: walls in 2 m and, from 300 degrees on, in 4 m; a speck before the wall at 200 degrees,
/// and a veiling point between the walls at 299.
class filtered {
 public:
  filtered() {
    filter_settings start;
    start.filter.in = frame::robot;
    parameters_ = std::make_unique<lidar_parameters>(start);
    for (const auto& [name, word] :
         {std::pair("edges", "off"), std::pair("fov", "-180:180"), std::pair("ignore", ""),
          std::pair("near", "off"), std::pair("near_as", "nan"), std::pair("no_return", "inf"),
          std::pair("speckle", "off")}) {
      parameters_->fix(name, std::string(word));
    }
    for (int i = 0; i < 360; ++i) {
      point& made = points_.emplace_back();
      made.angle_deg = static_cast<float>(i);
      made.range_mm = i == 200 ? 1000.0F : i < 299 ? 2000.0F : i == 299 ? 3000.0F : 4000.0F;
    }
  }
  /// Why not, or empty.
  std::string set(const std::string& name, parameter_value to) {
    std::string wrong =
        parameters_->change(nullptr, std::vector<named_value>{{name, std::move(to)}});
    const filter_settings& now = parameters_->filters();
    shaper_.set_options({.filter = now.complete_filter(), .marks = now.marks});
    return wrong;
  }
  [[nodiscard]] std::string value(const char* name) const {
    return std::get<std::string>(parameters_->value(*find_parameter(name)));
  }
  /// The angles of the device that are missing in the cloud.
  std::set<int> missing() {
    std::set<int> all;
    for (int i = 0; i < 360; ++i) all.insert(i);
    scan whole;
    whole.points = points_;
    shaper_.shape(whole);
    for (const auto& each : shaper_.kept()) {
      all.erase(static_cast<int>(each.angle_deg));
    }
    return all;
  }

  /// How a grid is filled.
  [[nodiscard]] grid_options grid() const { return parameters_->filters().grid; }
  /// Something at 0.4 m, in a revolution of one point.
  void come_near() {
    const point near{.angle_deg = 100.0F, .range_mm = 400.0F};
    scan whole;
    whole.points = {&near, 1};
    shaper_.shape(whole);
  }
  /// The flagged points of the next revolution, in which that beam has no return.
  std::size_t flagged() {
    const point none{.angle_deg = 96.9F, .revolution = 1, .flags = point_flags::no_return};
    scan whole;
    whole.points = {&none, 1};
    shaper_.shape(whole);
    return shaper_.for_grid().points.front().may_be_too_near() ? 1 : 0;
  }

 private:
  scan_shaper shaper_;
  std::unique_ptr<lidar_parameters> parameters_;
  std::vector<point> points_;
};

TEST(FilterParameters, AreThoseOfTheStart) {
  EXPECT_EQ(filtered().value("ignore"), "");
  EXPECT_EQ(filtered().value("speckle"), "off");
}

TEST(FilterParameters, DirectionsAreLeftOutFromNowOn) {
  filtered lidar;
  EXPECT_TRUE(lidar.missing().empty());
  EXPECT_EQ(lidar.set("ignore", "30.5:32.5 -91:-90"), "");
  // A direction of the robot is 180 degrees minus the angle of the device.
  EXPECT_EQ(lidar.missing(), (std::set<int>{148, 149, 270, 271}));
  EXPECT_THAT(lidar.set("ignore", "30:40 east"), testing::ContainsRegex("^ignore: .*east"));
  EXPECT_EQ(lidar.value("ignore"), "30.5:32.5 -91:-90");
  EXPECT_EQ(lidar.missing().size(), 4U);
  EXPECT_EQ(lidar.set("ignore", "10.5:11.5"), "");
  EXPECT_EQ(lidar.missing(), (std::set<int>{169}));
  EXPECT_EQ(lidar.set("ignore", "off"), "");
  EXPECT_TRUE(lidar.missing().empty());
}

TEST(FilterParameters, SpecksAreLeftOutFromNowOn) {
  filtered lidar;
  EXPECT_EQ(lidar.set("speckle", true), "");  // "on" in YAML
  EXPECT_EQ(lidar.value("speckle"), "on");
  EXPECT_EQ(lidar.missing(), (std::set<int>{200, 299}));
  EXPECT_THAT(lidar.set("speckle", "loud"), testing::ContainsRegex("^speckle: .*loud"));
  EXPECT_EQ(lidar.set("speckle", "near=0.1,window=3"), "");
  EXPECT_EQ(lidar.missing(), (std::set<int>{200, 299}));
  EXPECT_EQ(lidar.set("speckle", "near=100"), "");
  EXPECT_TRUE(lidar.missing().empty());
  EXPECT_EQ(lidar.set("speckle", "on"), "");
  EXPECT_EQ(lidar.set("speckle", "off"), "");
  EXPECT_TRUE(lidar.missing().empty());
}

TEST(FilterParameters, RangesWithoutReturn_ChangeFromNowOn) {
  using enum no_return_as;
  filtered lidar;
  EXPECT_EQ(lidar.set("no_return", "max"), "");
  EXPECT_EQ(lidar.set("near", true), "");
  EXPECT_EQ(lidar.value("no_return"), "max");
  EXPECT_EQ(lidar.value("near"), "on");
  EXPECT_EQ(lidar.value("near_as"), "nan");
  EXPECT_EQ(lidar.grid().no_return, max);
  EXPECT_FALSE(lidar.grid().near_is_minus_infinity);
  EXPECT_EQ(lidar.set("no_return", std::nan("")), "") << "nan in YAML";
  EXPECT_EQ(lidar.set("near_as", "minus-inf"), "");
  EXPECT_EQ(lidar.grid().no_return, nan);
  EXPECT_TRUE(lidar.grid().near_is_minus_infinity);
  EXPECT_THAT(lidar.set("no_return", "far"), HasSubstr("far"));
  EXPECT_EQ(lidar.grid().no_return, nan);
}

TEST(FilterParameters, WhatMayBeTooNearIsFlaggedFromNowOn) {
  filtered lidar;
  const auto flagged = [&] {
    lidar.come_near();
    return lidar.flagged();
  };
  EXPECT_EQ(flagged(), 0U);
  EXPECT_EQ(lidar.set("near", "on"), "");
  EXPECT_EQ(flagged(), 1U);
  EXPECT_EQ(lidar.set("near", "shortest=0.1"), "");
  EXPECT_EQ(flagged(), 0U);
  EXPECT_EQ(lidar.set("near", "off"), "");
  EXPECT_EQ(flagged(), 0U);
}

TEST(FilterParameters, VeilingPointsAreLeftOutFromNowOn) {
  filtered lidar;
  EXPECT_EQ(lidar.set("edges", "window=1,angle=4"), "");
  EXPECT_EQ(lidar.value("edges"), "window=1,angle=4");
  EXPECT_EQ(lidar.missing(), (std::set<int>{299}));
  EXPECT_EQ(lidar.set("edges", "off"), "");
  EXPECT_TRUE(lidar.missing().empty());
}

}  // namespace
}  // namespace g4lidar::test
