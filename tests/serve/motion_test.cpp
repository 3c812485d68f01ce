// SPDX-License-Identifier: MIT
// The place of the lidar in the messages of the page: points in the map are where the walls are.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "served.hpp"

namespace {

using namespace serve;

/// A revolution as a page gets it.
struct page_message {
  std::vector<std::uint8_t> data;

  template <class Number>
  [[nodiscard]] Number at(std::size_t place) const {
    Number value;
    std::memcpy(&value, &data.at(place), sizeof(value));
    return value;
  }
  [[nodiscard]] std::size_t count() const { return at<std::uint16_t>(2); }
  [[nodiscard]] bool has_place() const { return (data.at(1) & 2U) != 0; }
  [[nodiscard]] std::size_t place() const { return 16 + 8 * count(); }
  [[nodiscard]] std::uint32_t map() const { return at<std::uint32_t>(place()); }
  [[nodiscard]] pose_2d pose() const {
    return {at<double>(place() + 4), at<double>(place() + 12), at<double>(place() + 20)};
  }
};

/// A room of 8 m x 6 m, in which the robot begins in the middle, drives and turns.
class Moving : public Served {
 protected:
  Moving() {
    cli::write_file(path("room.txt"),
                    "wall -4 -3 4 -3\nwall 4 -3 4 3\nwall 4 3 -4 3\nwall -4 3 -4 -3\n"
                    "mount 0.3,0.1,90\nlidar 0 0 0\n"
                    "drive wait 1\ndrive forward 1.5 0.8\ndrive turn 120 90\ndrive forward 1 0.8\n"
                    "drive wait 2\n");
    EXPECT_EQ(cli::run({"sim", "--seconds", "10", "--world", path("room.txt"), "--odometry",
                        path("room.odo"), "-o", path("room.bin")})
                  .code,
              0);
  }
  void record_odometry() {
    EXPECT_EQ(cli::run({"record", path("room.bin"), "--odometry", path("room.odo"), "-o",
                        path("room.mcap")})
                  .code,
              0);
  }
  bool read_all() override {
    while (const auto message = center_.take(*page_)) {
      if (!message->is_text) messages_.push_back({*message->payload});
    }
    return scans_ < most_scans_;
  }
  /// How far the returns of all messages with a place are from the walls. `at`: where the map is in the room.
  [[nodiscard]] std::vector<double> distances(const pose_2d& at) const {
    std::vector<double> all;
    for (const page_message& each : messages_) {
      if (!each.has_place()) continue;
      const pose_2d lidar = at * each.pose();
      for (std::size_t i = 0; i < each.count(); ++i) {
        const auto x = static_cast<double>(each.at<float>(16 + 8 * i));
        const auto y = static_cast<double>(each.at<float>(20 + 8 * i));
        const pose_2d point = lidar * pose_2d{x, y, 0};
        all.push_back(
            std::min(std::abs(std::abs(point.x_m) - 4), std::abs(std::abs(point.y_m) - 3)));
      }
    }
    std::ranges::sort(all);
    return all;
  }

  client_registry::client* page_ = center_.connect(client_kind::page, nullptr);
  std::vector<page_message> messages_;
  std::uint64_t most_scans_ = UINT64_MAX;
};

TEST_F(Moving, ByOdometry_WallsStayWhereTheyAre) {
  if constexpr (std::endian::native != std::endian::little) GTEST_SKIP();
  record_odometry();
  serve_options options;
  options.common.mount = mounting{{0.3, 0.1, 1.5707963267948966}, false};
  play(path("room.mcap"), false, options);
  ASSERT_GT(messages_.size(), 40U);
  const auto all = distances({});
  ASSERT_GT(all.size(), 30'000U);
  EXPECT_LT(all[all.size() * 99 / 100], 0.02);
  const pose_2d last = messages_.back().pose();
  // 1.5 m ahead, 120 degrees to the left, 1 m ahead; then the place of the lidar on the robot.
  const pose_2d robot{1.5 + std::cos(2.0943951), std::sin(2.0943951), 2.0943951};
  const pose_2d wanted = robot * pose_2d{0.3, 0.1, 1.5707963};
  EXPECT_NEAR(last.x_m, wanted.x_m, 0.01);
  EXPECT_NEAR(last.y_m, wanted.y_m, 0.01);
  EXPECT_NEAR(last.yaw_rad, wanted.yaw_rad, 0.01);
}

}  // namespace
