// SPDX-License-Identifier: MIT
// Subscribers of every kind: none, late, slow, stopped.
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "cli/program.hpp"
#include "diagnosis.hpp"
#include "lidar.hpp"
#include "subscriber.hpp"
#include "support/test_scale.hpp"

namespace ros2 {
namespace {

using namespace std::chrono_literals;
using clock = std::chrono::steady_clock;

class Subscribers : public cli::scratch {
 protected:
  test_domain domain_;
};

/// Counts missing scans of a recording by their stamps.
class gap_count {
 public:
  void see(const scan_message& message) {
    const std::int64_t stamp_ns =
        message.header.stamp.sec * std::int64_t{1'000'000'000} + message.header.stamp.nanosec;
    // At 7 Hz a missing scan leaves a gap of 286 ms.
    gaps_ += before_ns_ != 0 && stamp_ns - before_ns_ > 200'000'000 ? 1 : 0;
    before_ns_ = stamp_ns;
  }
  [[nodiscard]] std::size_t gaps() const noexcept { return gaps_; }

 private:
  std::int64_t before_ns_ = 0;
  std::size_t gaps_ = 0;
};

/// A little more than so many scans at 7 Hz take: a recording that begins again has a gap there.
int seconds_of(std::size_t scans) { return static_cast<int>(scans / 7) + 10; }

TEST_F(Subscribers, TheMotorTurnsOnlyForThem) {
  const served_lidar lidar;
  cli::program tool({lidar.path(), "--standby"});
  subscriber<diagnostic_message> diagnostics(domain_, "/diagnostics", dds::diagnostic_array);
  ASSERT_TRUE(comes_true([&] { return diagnostics.take() > 0; }));
  EXPECT_FALSE(lidar.motor_turns());
  {
    const auto begin = clock::now();
    subscriber<scan_message> scans(domain_, "/scan", dds::laser_scan);
    EXPECT_TRUE(comes_true([&] { return lidar.motor_turns(); }));
    // The limit is that of bench/ros2_delay: here other programs may run.
    std::printf("subscriber to turning motor: %.0f ms\n",
                std::chrono::duration<double, std::milli>(clock::now() - begin).count());
    EXPECT_TRUE(comes_true([&] { return scans.take() > 0; }));
  }
  EXPECT_TRUE(comes_true([&] { return !lidar.motor_turns(); }));
  subscriber<cloud_message> clouds(domain_, "/points", dds::point_cloud2);
  EXPECT_TRUE(comes_true([&] { return clouds.take() > 0; }));
  tool.send(SIGINT);
  EXPECT_EQ(tool.wait().code, 130);
  EXPECT_FALSE(lidar.motor_turns());
}

TEST_F(Subscribers, NoScanIsLostAndEachReaderHasItsOwnSpeed) {
  const std::string file = path("walk.mcap");
  const auto wanted = static_cast<std::size_t>(1000 * g4lidar::test::test_scale());
  make_recording(file, seconds_of(wanted));
  subscriber<scan_message> fast(domain_, "/scan", dds::laser_scan, {.depth = 1000});
  subscriber<scan_message> slow(domain_, "/scan", dds::laser_scan, {.depth = 10});
  cli::program tool(
      {file, "--standby", "--playback-speed", "40", "--points-topic", "off", "--depth", "1000"});
  std::size_t got = 0;
  std::size_t got_slowly = 0;
  gap_count gaps;
  auto due = clock::now();
  ASSERT_TRUE(comes_true(
      [&] {
        got += fast.take([&](const scan_message& message) { gaps.see(message); });
        if (clock::now() >= due) {
          got_slowly += slow.take();
          due = clock::now() + 500ms;
        }
        return got >= wanted;
      },
      std::chrono::seconds(60 * g4lidar::test::test_scale() + 60)));
  EXPECT_EQ(gaps.gaps(), 0U);
  EXPECT_GT(got_slowly, 0U);
  EXPECT_LT(got_slowly, got / 2);
  tool.send(SIGINT);
}

// So fast that a reader may be kept from the processor for 0.35 s.
TEST_F(Subscribers, NoScanIsLostWithTheDefaultDepths) {
  const std::string file = path("walk.mcap");
  const auto wanted = static_cast<std::size_t>(100 * g4lidar::test::test_scale());
  make_recording(file, seconds_of(wanted));
  subscriber<scan_message> scans(domain_, "/scan", dds::laser_scan);
  cli::program tool({file, "--standby", "--playback-speed", "2"});
  std::size_t got = 0;
  gap_count gaps;
  ASSERT_TRUE(comes_true(
      [&] {
        got += scans.take([&](const scan_message& message) { gaps.see(message); });
        return got >= wanted;
      },
      std::chrono::seconds(60 * g4lidar::test::test_scale() + 60)));
  EXPECT_EQ(gaps.gaps(), 0U);
  tool.send(SIGINT);
}

/// Reads until it is killed, for the next test.
TEST_F(Subscribers, DISABLED_ReadsForever) {
  subscriber<cloud_message> clouds(domain_, "/points", dds::point_cloud2);
  const pid_t parent = ::getppid();
  while (::getppid() == parent) {
    static_cast<void>(clouds.take());
    std::this_thread::sleep_for(10ms);
  }
}

TEST_F(Subscribers, OneThatStandsStillHoldsUpNobody) {
  const std::string file = path("walk.mcap");
  make_recording(file, 20);
  subscriber<cloud_message> clouds(domain_, "/points", dds::point_cloud2, {.depth = 1000});
  subscriber<cloud_message> never_read(domain_, "/points", dds::point_cloud2, {.depth = 5});
  const std::string identity = std::to_string(test_domain::identity());
  ::setenv("G4_ROS2_TEST_IDENTITY", identity.c_str(), 1);
  const pid_t child = ::fork();
  if (child == 0) {
    ::execl("/proc/self/exe", "ros2_tests", "--gtest_also_run_disabled_tests",
            "--gtest_filter=Subscribers.DISABLED_ReadsForever", nullptr);
    ::_exit(1);
  }
  cli::program tool({file, "--standby", "--loop", "--playback-speed", "10"});
  diagnosis diagnostics(domain_);
  ASSERT_TRUE(comes_true([&] { return diagnostics["/points subscribers"] == "3"; }));
  const auto replaced = [&] { return std::atoi(diagnostics["/points unacknowledged"].c_str()); };
  ASSERT_TRUE(comes_true([&] { return diagnostics["g4lidar: topics level"] == "0"; }));
  const int replaced_before = replaced();
  ::kill(child, SIGSTOP);
  static_cast<void>(clouds.take());
  std::size_t got = 0;
  // Far beyond what any queue holds: 31 KB each.
  EXPECT_TRUE(comes_true([&] { return (got += clouds.take()) >= 300; }, 60s)) << got;
  EXPECT_TRUE(comes_true([&] { return replaced() > replaced_before; }));
  ::kill(child, SIGCONT);
  const std::size_t seen = got;
  EXPECT_TRUE(comes_true([&] { return (got += clouds.take()) > seen; }));
  EXPECT_LE(replaced(), std::atoi(diagnostics["/points sent"].c_str()) - 5);
  // Nobody knows what it has missed: no warning.
  EXPECT_EQ(diagnostics["/points lost"], "0");
  EXPECT_EQ(diagnostics["g4lidar: topics warning"], "");
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  tool.send(SIGINT);
  EXPECT_EQ(tool.wait().code, 130);
}

}  // namespace
}  // namespace ros2
