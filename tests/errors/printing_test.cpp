// SPDX-License-Identifier: MIT
// Errors, points and scans with std::ostream, {fmt} and std::error_code.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cerrno>
#include <set>
#include <sstream>
#include <string>
#include <system_error>

#include "g4lidar/error_code.hpp"
#include "g4lidar/fmt.hpp"
#include "g4lidar/ostream.hpp"

namespace g4lidar::test {
namespace {

/// The output of both.
template <class T>
std::string printed(const T& what) {
  std::ostringstream out;
  out << what;
  EXPECT_EQ(fmt::format("{}", what), out.str());
  return out.str();
}

TEST(Printing, OfErrors) {
  EXPECT_EQ(printed(problem::no_port), "no_port");
  EXPECT_EQ(printed(task::configuring), "configuring");
  const error why(task::opening, problem::permission, "/dev/ttyUSB0", EACCES);
  EXPECT_EQ(printed(why), why.message());
  EXPECT_EQ(fmt::format("{:>10}|", problem::busy), "      busy|");
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

TEST(ErrorCode, NamesEachProblemAndIsNeverZero) {
  std::set<std::string> messages;
  for (std::size_t i = 0; i < problem_count; ++i) {
    const std::error_code code = static_cast<problem>(i);
    EXPECT_TRUE(code) << i;
    EXPECT_STREQ(code.category().name(), "g4lidar");
    EXPECT_EQ(code, static_cast<problem>(i));
    messages.insert(code.message());
  }
  EXPECT_EQ(messages.size(), problem_count);
  EXPECT_EQ(std::error_code(0, error_category()).message(), "unknown");
  EXPECT_EQ(std::error_code(problem_count + 1, error_category()).message(), "unknown");
}

TEST(ErrorCode, ComparesWithStandardConditions) {
  const error why(task::opening, problem::permission, "/dev/ttyUSB0", EACCES);
  EXPECT_EQ(why, problem::permission);
  EXPECT_NE(why, problem::busy);
  EXPECT_EQ(make_error_code(why), problem::permission);
  EXPECT_EQ(make_error_code(why), std::errc::permission_denied);
  EXPECT_EQ(make_error_code(problem::timeout), std::errc::timed_out);
  EXPECT_EQ(make_error_code(problem::cancelled), std::errc::operation_canceled);
  EXPECT_EQ(make_error_code(problem::gone), std::errc::no_such_device);
  EXPECT_NE(make_error_code(problem::garbage), std::errc::io_error);
}

}  // namespace
}  // namespace g4lidar::test
