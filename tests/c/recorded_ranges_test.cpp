// SPDX-License-Identifier: MIT
// The ranges of recorded LaserScan messages in directions without return.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "c_handles.hpp"
#include "support/laser_scan.hpp"
#include "support/mcap_messages.hpp"

namespace {

using namespace g4lidar_c_test;

constexpr std::int64_t second = 1'000'000'000;

recorder record_to(const std::string& path, const g4lidar_recorder_options& options) {
  g4lidar_recorder* made = nullptr;
  g4lidar_error why;
  EXPECT_EQ(g4lidar_recorder_create(path.c_str(), &options, &made, &why), G4LIDAR_OK)
      << why.message;
  return recorder(made);
}

class CRecordedRanges : public testing::Test {
 protected:
  scratch scratch_;
  std::string path_ = scratch_.path("near.mcap");
};

TEST_F(CRecordedRanges, NoReturnsFollowItsOptions) {
  struct seen {
    float ahead;
    float behind;
  };
  // A wall ahead comes nearer than 0.28 m; behind there is nothing. The last LaserScan.
  const auto last_scan = [&](auto change) {
    g4lidar_recorder_options wanted;
    g4lidar_recorder_options_init(&wanted, sizeof wanted);
    wanted.overwrite = true;
    change(wanted);
    {
      const simulator device = simulate(nullptr, "wall 1 -1 1 1\nlidar 0 0 0\nmount 0,0,0\n",
                                        "drive wait 1\ndrive forward 0.85 0.5\ndrive wait 9\n");
      const recorder into = record_to(path_, wanted);
      g4lidar_options options = defaults();
      options.recorder = into.get();
      const lidar it = start_on(device, &options);
      while (g4lidar_simulator_get_state(device.get())->time_ns < 6 * second) next_whole(it);
    }
    std::ifstream file(path_, std::ios::binary);
    const auto messages = g4lidar::test::mcap_messages(
        std::string(std::istreambuf_iterator<char>(file), {}), "/scan");
    const std::vector<float> ranges = g4lidar::test::read_laser_scan(messages.back()).ranges;
    EXPECT_EQ(ranges.size(), 720U);
    return seen{ranges.at(360), ranges.at(0)};
  };
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const seen usual = last_scan([](auto&) {});
  EXPECT_EQ(usual.ahead, infinity);
  EXPECT_EQ(usual.behind, infinity);
  EXPECT_EQ(last_scan([](auto& wanted) { wanted.no_return = G4LIDAR_NO_RETURN_AS_MAX; }).behind,
            16.0F);
  EXPECT_TRUE(std::isnan(
      last_scan([](auto& wanted) { wanted.no_return = G4LIDAR_NO_RETURN_AS_NAN; }).behind));
  g4lidar_near_options limits;
  g4lidar_near_options_init(&limits, sizeof limits);
  limits.revolutions = 0;  // until a return comes
  const seen unknown = last_scan([&](auto& wanted) { wanted.near_options = &limits; });
  EXPECT_TRUE(std::isnan(unknown.ahead));
  EXPECT_EQ(unknown.behind, infinity);
  const seen near = last_scan([&](auto& wanted) {
    wanted.near_options = &limits;
    wanted.near_is_minus_infinity = 1;
    wanted.no_return = G4LIDAR_NO_RETURN_AS_NAN;
  });
  EXPECT_EQ(near.ahead, -infinity);
  EXPECT_TRUE(std::isnan(near.behind));
}

TEST_F(CRecordedRanges, ImpossibleOptionsOfRangesAreRefused) {
  const auto created = [&](auto change) {
    g4lidar_recorder_options wanted;
    g4lidar_recorder_options_init(&wanted, sizeof wanted);
    change(wanted);
    g4lidar_recorder* into = nullptr;
    const int code = g4lidar_recorder_create(path_.c_str(), &wanted, &into, nullptr);
    EXPECT_EQ(into, nullptr);
    return code;
  };
  EXPECT_EQ(created([](auto& wanted) { wanted.no_return = 3; }), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(created([](auto& wanted) { wanted.near_is_minus_infinity = 2; }), G4LIDAR_BAD_ARGUMENT);
  g4lidar_near_options limits;
  g4lidar_near_options_init(&limits, sizeof limits);
  limits.shortest_mm = -1.0F;
  EXPECT_EQ(created([&](auto& wanted) { wanted.near_options = &limits; }), G4LIDAR_BAD_ARGUMENT);
  EXPECT_FALSE(std::filesystem::exists(path_));
}

}  // namespace
