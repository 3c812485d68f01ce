// SPDX-License-Identifier: MIT
// A scan as a picture: where each point is drawn, and which are omitted.
#include <gmock/gmock.h>

#include <string>
#include <string_view>
#include <vector>

#include "export/svg.hpp"

namespace g4lidar {
namespace {

using namespace g4_tool;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

point at(float angle_deg, float range_mm, point_flags flags = point_flags::none) {
  point p;
  p.angle_deg = angle_deg;
  p.range_mm = range_mm;
  p.flags = flags;
  return p;
}

std::string drawn(const std::vector<point>& points) {
  std::string all;
  callback_sink sink([&](std::string_view text) { all += text; });
  write_svg(points, sink);
  sink.flush();
  return all;
}

TEST(Svg, ForwardIsUpAndLeftIsLeft) {
  // The cable is at 0 degrees, at the back of the robot; angles grow clockwise.
  EXPECT_THAT(drawn({at(180, 2000)}), HasSubstr("\"M0 -200h0\"")) << "forward";
  EXPECT_THAT(drawn({at(0, 2000)}), HasSubstr("\"M0 200h0\"")) << "backward";
  EXPECT_THAT(drawn({at(90, 2000)}), HasSubstr("\"M-200 0h0\"")) << "left";
  EXPECT_THAT(drawn({at(270, 2000)}), HasSubstr("\"M200 0h0\"")) << "right";
}

TEST(Svg, NoReturnsAndTooNearPoints_AreLeftOut) {
  const std::string picture =
      drawn({at(180, 3000), at(90, 0, point_flags::no_return), at(270, 40, point_flags::too_near)});
  EXPECT_THAT(picture, HasSubstr("<path d=\"M0 -300h0\" "));
}

TEST(Svg, ContainsEveryPointAndCirclesAtEachMetre) {
  const std::string near = drawn({at(180, 2500)});
  EXPECT_THAT(near, StartsWith("<svg xmlns"));
  EXPECT_THAT(near, HasSubstr("viewBox=\"-270 -270 540 540\""));
  EXPECT_THAT(near, HasSubstr("<circle r=\"100\"/>\n<circle r=\"200\"/>\n</g>"));
  EXPECT_THAT(near, EndsWith("</svg>\n"));
  const std::string far = drawn({at(180, 12'000)});
  EXPECT_THAT(far, HasSubstr("<circle r=\"500\"/>\n<circle r=\"1000\"/>\n</g>"));
}

TEST(Svg, NoPoints_StillGiveAPicture) {
  EXPECT_THAT(drawn({}), HasSubstr("viewBox=\"-120 -120 240 240\""));
  EXPECT_THAT(drawn({}), Not(HasSubstr("h0")));
}

}  // namespace
}  // namespace g4lidar
