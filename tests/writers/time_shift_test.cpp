// SPDX-License-Identifier: MIT
// Times of any value, in each style: nothing overflows.
#include "export/time_shift.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace g4lidar {
namespace {

using namespace g4_tool;

constexpr std::int64_t least = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t greatest = std::numeric_limits<std::int64_t>::max();

// In constant expressions an overflow does not compile.
constexpr std::int64_t second_of(time_style style, std::int64_t first_ns, std::int64_t second_ns,
                                 std::int64_t wall_ahead_ns = 0) {
  time_shift shift(style, 0);
  shift.set_wall_ahead(wall_ahead_ns);
  shift.arrived(first_ns);
  static_cast<void>(shift.of(first_ns));
  return shift.of(second_ns);
}

static_assert(second_of(time_style::delta, 10, 17) == 7);
static_assert(second_of(time_style::delta, least, greatest) == greatest);
static_assert(second_of(time_style::delta, greatest, least) == least);
static_assert(second_of(time_style::delta, least, least + 5) == 5);
static_assert(second_of(time_style::zero, 10, 17) == 7);
static_assert(second_of(time_style::zero, least, greatest) == greatest);
static_assert(second_of(time_style::zero, greatest, least) == least);
static_assert(second_of(time_style::zero, least, least + 5) == 5);
static_assert(second_of(time_style::absolute, 1, greatest, greatest) == greatest);
static_assert(second_of(time_style::absolute, 1, least, least) == least);
static_assert(second_of(time_style::absolute, 1, 2, 5'000'000) == 5'000'002);
static_assert(second_of(time_style::monotonic, 1, greatest, greatest) == greatest);

TEST(TimeShift, WallClockThatIsSetFarAway_DoesNotOverflow) {
  time_shift shift(time_style::absolute, least);
  shift.set_wall_ahead(greatest);
  EXPECT_EQ(shift.of(0), greatest);
  EXPECT_EQ(shift.of(1), greatest);
}

TEST(TimeShift, ChangesNothing_WhereEachTimeStays) {
  time_shift zero(time_style::zero, 5);
  EXPECT_FALSE(zero.changes_nothing()) << "the first time is not known";
  zero.arrived(0);
  EXPECT_TRUE(zero.changes_nothing());
  time_shift later(time_style::zero, 0);
  later.arrived(3);
  EXPECT_FALSE(later.changes_nothing());
  EXPECT_FALSE(time_shift(time_style::delta, 0).changes_nothing());
  EXPECT_TRUE(time_shift(time_style::monotonic, 7).changes_nothing());
  EXPECT_FALSE(time_shift(time_style::absolute, 7).changes_nothing());
}

}  // namespace
}  // namespace g4lidar
