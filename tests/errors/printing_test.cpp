// SPDX-License-Identifier: MIT
// Errors, points and scans with std::ostream.
#include <gtest/gtest.h>

#include <array>
#include <cerrno>
#include <set>
#include <sstream>
#include <string>
#include <string_view>

#include "g4lidar/error.hpp"
#include "g4lidar/ostream.hpp"

namespace g4lidar::test {
namespace {

template <class T>
std::string printed(const T& what) {
  std::ostringstream out;
  out << what;
  return out.str();
}

TEST(Printing, OfErrors) {
  EXPECT_EQ(printed(problem::no_port), "no_port");
  EXPECT_EQ(printed(task::configuring), "configuring");
  const error why(task::opening, problem::permission, "/dev/ttyUSB0", EACCES);
  EXPECT_EQ(printed(why), why.message());
}

TEST(Printing, OfPoints) {
  point p;
  p.angle_deg = 12.3456F;
  p.range_mm = 1234.56F;
  EXPECT_EQ(printed(p), "12.346 deg, 1234.6 mm");
  p.range_mm = 60.0F;
  p.flags = point_flags::too_near;
  EXPECT_EQ(printed(p), "12.346 deg, 60.0 mm, too near");
  p.range_mm = 0.0F;
  p.flags = point_flags::no_return | point_flags::revolution_start;
  EXPECT_EQ(printed(p), "12.346 deg, no return");
  p.flags = p.flags | point_flags::unlikely;
  EXPECT_EQ(printed(p), "12.346 deg, no return, unlikely");
  p.range_mm = 16'383.75F;
  p.flags = point_flags::too_near | point_flags::not_deskewed | point_flags::unlikely |
            point_flags::isolated | point_flags::veiling | point_flags::may_be_too_near;
  EXPECT_EQ(printed(p),
            "12.346 deg, 16383.8 mm, too near, not deskewed, unlikely, isolated, veiling, "
            "may be too near");
}

TEST(Printing, OfScans) {
  const std::array<point, 3> points{};
  scan s;
  s.points = points;
  s.revolution = 4294967295U;
  EXPECT_EQ(printed(s), "scan 4294967295: 3 points");
  s.flags = scan_flags::end_missing | scan_flags::data_lost;
  EXPECT_EQ(printed(s), "scan 4294967295: 3 points, end_missing data_lost");
}

TEST(Errors, CompareWithTheirProblem) {
  const error why(task::opening, problem::permission, "/dev/ttyUSB0", EACCES);
  EXPECT_EQ(why, problem::permission);
  EXPECT_NE(why, problem::busy);
}

TEST(Errors, EachProblemHasADescriptionOfItsOwn) {
  std::set<std::string_view> all;
  for (std::size_t i = 0; i < problem_count; ++i)
    all.insert(description_of(static_cast<problem>(i)));
  EXPECT_EQ(all.size(), problem_count);
}

}  // namespace
}  // namespace g4lidar::test
