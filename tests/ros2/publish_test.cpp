// SPDX-License-Identifier: MIT
// g4-ros2 publishes, and readers of Cyclone DDS in another process read.
#include <gmock/gmock.h>

#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "cli/program.hpp"
#include "g4lidar/cartesian.hpp"
#include "g4lidar/grid.hpp"
#include "lidar.hpp"
#include "subscriber.hpp"

namespace ros2 {
namespace {

using ::testing::ElementsAre;
using ::testing::Pointwise;

class Publish : public cli::scratch {
 protected:
  test_domain domain_;
};

std::vector<std::uint32_t> bits_of(std::span<const float> values) {
  std::vector<std::uint32_t> bits;
  for (const float value : values) {
    bits.push_back(std::isnan(value) ? 0xFFFFFFFF : std::bit_cast<std::uint32_t>(value));
  }
  return bits;
}

TEST_F(Publish, EveryScanOfARecordingNumberByNumber) {
  const std::string file = path("walk.mcap");
  make_recording(file, 4);
  std::vector<std::vector<std::uint32_t>> wanted;
  for (const g4lidar::owned_scan& scan : scans_of(file)) {
    std::array<float, 720> ranges{};
    g4lidar::fill_grid(scan.points(), ranges);
    if (!scan.view().is_piece()) wanted.push_back(bits_of(ranges));
  }
  ASSERT_GT(wanted.size(), 20U);
  subscriber<scan_message> scans(domain_, "/scan", dds::laser_scan, {.depth = 100});
  // At rest it does not play, so nothing is missed before the subscriber is there.
  cli::program tool({file, "--standby", "--playback-speed", "8"});
  std::vector<std::vector<std::uint32_t>> got;
  EXPECT_TRUE(comes_true([&] {
    scans.take([&](const scan_message& message) {
      got.push_back(bits_of({message.ranges._buffer, message.ranges._length}));
      EXPECT_STREQ(message.header.frame_id, "laser");
      EXPECT_FLOAT_EQ(message.angle_min, -std::numbers::pi_v<float>);
      EXPECT_FLOAT_EQ(message.angle_increment, 2 * std::numbers::pi_v<float> / 720);
    });
    return got.size() >= wanted.size();
  }));
  EXPECT_EQ(got, wanted);
  EXPECT_EQ(tool.wait().code, 0);
}

TEST_F(Publish, TheLongestRangeIsTheLimitOfTheOption_AndTheOrderOfTimeIsExplained) {
  subscriber<scan_message> scans(domain_, "/scan", dds::laser_scan);
  cli::program tool({"sim:", "--range", "0.1:2.5", "--no-return", "max", "--order", "time"});
  std::size_t count = 0;
  EXPECT_TRUE(comes_true([&] {
    count += scans.take([](const scan_message& message) {
      EXPECT_EQ(message.range_max, 2.5F);
      const std::span ranges(message.ranges._buffer, message.ranges._length);
      EXPECT_TRUE(std::ranges::none_of(ranges, [](float range) { return range > 2.5F; }));
    });
    return count >= 3;
  }));
  tool.send(SIGINT);
  const cli::outcome end = tool.wait();
  EXPECT_EQ(end.code, 130);
  EXPECT_NE(end.err.find("--order time is not for slam_toolbox"), std::string::npos) << end.err;
}

/// What subscriber and publisher want.
struct combination {
  bool reader_is_reliable;
  const char* offered;
  bool matches;
};

class Quality : public Publish, public ::testing::WithParamInterface<combination> {};

TEST_P(Quality, OfServiceDecidesWhoReads) {
  const auto& [reader_is_reliable, offered, matches] = GetParam();
  const served_lidar lidar;
  subscriber<scan_message> scans(domain_, "/scan", dds::laser_scan,
                                 {.is_reliable = reader_is_reliable});
  // The other one is accepted in any case: then it is known that the first one was refused.
  subscriber<scan_message> witness(domain_, "/scan", dds::laser_scan, {.is_reliable = false});
  cli::program tool({lidar.path(), "--qos", offered});
  std::size_t seen = 0;
  ASSERT_TRUE(comes_true([&] { return (seen += witness.take()) >= 5; }));
  if (matches) {
    EXPECT_TRUE(comes_true([&] { return scans.take() > 0; }));
  } else {
    EXPECT_EQ(scans.publishers(), 0U);
  }
  tool.send(SIGINT);
}

INSTANTIATE_TEST_SUITE_P(All, Quality,
                         ::testing::Values(combination{true, "reliable", true},
                                           combination{false, "reliable", true},
                                           combination{false, "best-effort", true},
                                           combination{true, "best-effort", false}),
                         [](const auto& which) {
                           const combination& one = which.param;
                           return std::string(one.reader_is_reliable ? "Reliable" : "BestEffort") +
                                  (one.offered[0] == 'r' ? "_From_Reliable" : "_From_BestEffort");
                         });

TEST_F(Publish, ThePlaceOfTheLidarForLateReaders) {
  const served_lidar lidar;
  subscriber<scan_message> scans(domain_, "/scan", dds::laser_scan);
  cli::program tool({lidar.path(), "--mount", "0.2,-0.1,90", "--frame-id", "front_laser"});
  ASSERT_TRUE(comes_true([&] { return scans.take() > 0; }));
  subscriber<tf_message> places(domain_, "/tf_static", dds::tf_message, {.is_for_late = true});
  std::vector<std::string> names;
  std::vector<double> numbers;
  ASSERT_TRUE(comes_true([&] {
    return places.take([&](const tf_message& message) {
      ASSERT_EQ(message.transforms._length, 1U);
      const auto& one = message.transforms._buffer[0];
      names = {one.header.frame_id, one.child_frame_id};
      numbers = {one.transform.translation.x, one.transform.translation.y, one.transform.rotation.z,
                 one.transform.rotation.w};
    }) > 0;
  }));
  EXPECT_THAT(names, ElementsAre("base_link", "front_laser"));
  const double half = std::numbers::sqrt2 / 2;
  EXPECT_THAT(numbers, Pointwise(::testing::DoubleNear(1e-12), {0.2, -0.1, half, half}));
  tool.send(SIGINT);
}

TEST_F(Publish, SettingsOfARecordingWithOdometryAreRefusedWithTheReason) {
  const std::string file = path("walk.mcap");
  cli::write_file(path("way.txt"), "drive forward 0.5 0.5\n");
  make_recording(file, 1, "--path " + path("way.txt") + " --odometry " + path("way.odo"),
                 "--odometry " + path("way.odo"));
  const cli::outcome end = cli::program({file, "--set", "frequency=10"}).wait();
  EXPECT_NE(end.err.find("a file cannot be asked or set"), std::string::npos) << end.err;
}

TEST_F(Publish, AMissingFileIsReportedOnce) {
  cli::program tool({path("nofile.mcap")});
  const cli::outcome end = tool.wait();
  EXPECT_NE(end.code, 0);
  const std::size_t first = end.err.find("nofile.mcap");
  ASSERT_NE(first, std::string::npos) << end.err;
  EXPECT_EQ(end.err.find("nofile.mcap", first + 1), std::string::npos) << end.err;
}

}  // namespace
}  // namespace ros2
