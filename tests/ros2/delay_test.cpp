// SPDX-License-Identifier: MIT
// The delay from the zero packet that ends a scan to the callback of a subscriber: bench/ros2_delay.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "cli/program.hpp"
#include "g4lidar/lidar.hpp"
#include "lidar.hpp"
#include "subscriber.hpp"

namespace ros2 {
namespace {

using namespace std::chrono_literals;

std::int64_t now_ns() {
  return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// When scans came.
class arrivals {
 public:
  void add() {
    const std::int64_t now = now_ns();
    const std::lock_guard lock(mutex_);
    times_.push_back(now);
  }
  [[nodiscard]] std::vector<std::int64_t> all() {
    const std::lock_guard lock(mutex_);
    return times_;
  }

 private:
  std::mutex mutex_;
  std::vector<std::int64_t> times_;
};

/// The median and the 90th percentile, in milliseconds, of the time since the last zero packet before.
std::array<double, 2> delays_ms(const std::vector<std::int64_t>& zero_ns,
                                const std::vector<std::int64_t>& came_ns) {
  std::vector<double> delays;
  for (const std::int64_t came : came_ns) {
    const auto after = std::ranges::upper_bound(zero_ns, came);
    if (after != zero_ns.begin()) delays.push_back(static_cast<double>(came - *(after - 1)) * 1e-6);
  }
  EXPECT_GT(delays.size(), 10U);
  if (delays.empty()) return {};
  std::ranges::sort(delays);
  return {delays[delays.size() / 2], delays[delays.size() * 9 / 10]};
}

/// Looks when zero packets are sent, for so long.
std::vector<std::int64_t> zero_packets(const served_lidar& lidar, std::chrono::seconds length) {
  std::vector<std::int64_t> found;
  const std::int64_t end_ns = now_ns() + std::chrono::nanoseconds(length).count();
  while (now_ns() < end_ns) {
    lidar.take_zero_packets(found);
    std::this_thread::sleep_for(10ms);
  }
  return found;
}

TEST(Delay, DISABLED_OfASubscriberIsThatOfTheDriver) {
  constexpr auto length = 20s;
  const test_domain domain;
  arrivals direct;
  std::array<double, 2> driver{};
  {
    const served_lidar lidar;
    auto opened = g4lidar::lidar::open(lidar.path());
    ASSERT_TRUE(opened && opened->start());
    std::jthread reader([&](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        if (opened->try_scan(100ms)) direct.add();
      }
    });
    const auto zeros = zero_packets(lidar, length);
    reader.request_stop();
    reader.join();
    driver = delays_ms(zeros, direct.all());
  }
  const served_lidar lidar;
  arrivals heard;
  subscriber<scan_message> scans(domain, "/scan", dds::laser_scan);
  dds_listener_t* const listener = dds_create_listener(&heard);
  dds_lset_data_available(listener,
                          [](dds_entity_t, void* to) { static_cast<arrivals*>(to)->add(); });
  static_cast<void>(dds_set_listener(scans.handle(), listener));
  dds_delete_listener(listener);
  cli::program tool({lidar.path()});
  const auto zeros = zero_packets(lidar, length);
  tool.send(SIGINT);
  tool.wait();
  static_cast<void>(dds_set_listener(scans.handle(), nullptr));
  const auto subscriber = delays_ms(zeros, heard.all());
  std::printf("zero packet to try_scan():  median %.2f ms, 90th percentile %.2f ms\n", driver[0],
              driver[1]);
  std::printf("zero packet to a subscriber: median %.2f ms, 90th percentile %.2f ms\n",
              subscriber[0], subscriber[1]);
  EXPECT_LT(subscriber[0], driver[0] + 1.0);
}

TEST(Delay, DISABLED_OfTheFirstSubscriberInStandby) {
  const test_domain domain;
  std::vector<double> started_ms;
  for (int i = 0; i < 5; ++i) {
    const served_lidar lidar;
    cli::program tool({lidar.path(), "--standby"});
    subscriber<diagnostic_message> diagnostics(domain, "/diagnostics", dds::diagnostic_array);
    ASSERT_TRUE(comes_true([&] { return diagnostics.take() > 0; }));
    const std::int64_t begin_ns = now_ns();
    subscriber<scan_message> scans(domain, "/scan", dds::laser_scan);
    ASSERT_TRUE(comes_true([&] { return lidar.motor_turns(); }));
    started_ms.push_back(static_cast<double>(now_ns() - begin_ns) * 1e-6);
    tool.send(SIGINT);
    tool.wait();
  }
  std::ranges::sort(started_ms);
  std::printf("subscriber to turning motor: median %.0f ms, longest %.0f ms of 5\n", started_ms[2],
              started_ms[4]);
  EXPECT_LT(started_ms[2], 1000.0);
}

}  // namespace
}  // namespace ros2
