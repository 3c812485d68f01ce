// SPDX-License-Identifier: MIT
// The simulated G4 in a program of its own, which is killed or paused: g4-dump sim --link.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <memory>
#include <string>
#include <thread>

#include "realtime/child_process.hpp"
#include "realtime/device_on_pty.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using clock = std::chrono::steady_clock;

class SimulatorProgram : public testing::Test {
 protected:
  void begin() {
    program_.reset();  // its link is free for the next one
    program_ = std::make_unique<test::child_process>(
        std::vector<std::string>{G4_DUMP, "sim", "--link", path_}, directory_.file("output"));
    ASSERT_TRUE(program_->prints(" at " + path_)) << program_->output();
  }

  test::scratch_directory directory_;
  std::string path_ = directory_.file("g4");
  std::unique_ptr<test::child_process> program_;
};

/// The time from its end until the error.
clock::duration time_to_know_the_end(lidar& device, const test::child_process& program) {
  clock::time_point killed;
  std::thread hand([&] {
    std::this_thread::sleep_for(50ms);
    killed = clock::now();
    program.send(SIGKILL);
  });
  auto scan = device.try_scan(test::patience);
  while (scan) scan = device.try_scan(test::patience);
  const auto known = clock::now();
  hand.join();
  EXPECT_EQ(scan.error().code(), problem::gone) << scan.error().message();
  return known - killed;
}

// The 75th percentile of 8 runs.
TEST_F(SimulatorProgram, Killed_IsGone) {
  test::expect_percentile_below(100ms, 75, 8, [&] {
    begin();
    auto device = lidar::open(test::patient_options(path_));
    EXPECT_TRUE(device && device->start() && device->try_scan(test::patience));
    const auto time = device ? time_to_know_the_end(*device, *program_) : clock::duration(0);
    EXPECT_EQ(program_->wait(), 128 + SIGKILL);
    return time;
  });
}

TEST_F(SimulatorProgram, KilledAndRestarted_IsTheSameDevice) {
  begin();
  lidar_options options;
  options.device = path_;
  options.reconnect = true;
  auto device = lidar::open(options);
  ASSERT_TRUE(device) << device.error().message();
  ASSERT_TRUE(device->start());
  ASSERT_TRUE(device->try_scan(test::patience));
  program_->send(SIGKILL);
  EXPECT_EQ(program_->wait(), 128 + SIGKILL);
  begin();
  const auto end = clock::now() + test::patience;
  while (device->counts().reconnects == 0 && clock::now() < end) {
    const auto scan = device->try_scan(100ms);
    if (!scan) {
      ASSERT_FALSE(scan.error().is_fatal()) << scan.error().message();
    }
  }
  EXPECT_EQ(device->counts().reconnects, 1U);
  EXPECT_TRUE(device->try_scan(test::patience));
}

// Like a short suspension of a laptop, or a debugger: afterwards everything continues as before.
TEST_F(SimulatorProgram, PausedForASecond_Continues) {
  begin();
  lidar_options options;
  options.device = path_;
  options.reconnect = true;
  auto device = lidar::open(options);
  ASSERT_TRUE(device) << device.error().message();
  ASSERT_TRUE(device->start());
  ASSERT_TRUE(device->try_scan(test::patience));
  program_->send(SIGSTOP);
  std::thread hand([&] {
    std::this_thread::sleep_for(1s);
    program_->send(SIGCONT);
  });
  int scans = 0;
  const auto end = clock::now() + test::patience;
  while (scans < 10 && clock::now() < end) {
    const auto scan = device->try_scan(100ms);
    if (scan) {
      ++scans;
    } else {
      EXPECT_FALSE(scan.error().is_fatal()) << scan.error().message();
    }
  }
  hand.join();
  EXPECT_EQ(scans, 10);
  test::expect_identity(device->counts());
}

// Without reconnecting, a short silence is not an error either. The delayed bytes are sent at once,
// and a pseudo-terminal holds no more than 0.8 s of them.
TEST_F(SimulatorProgram, PausedBriefly_IsNoEvent) {
  test::expect_three_of_four([&] {
    begin();
    auto device = lidar::open(test::patient_options(path_));
    EXPECT_TRUE(device && device->start() && device->try_scan(test::patience));
    if (!device) return false;
    program_->send(SIGSTOP);
    std::thread hand([&] {
      std::this_thread::sleep_for(400ms);
      program_->send(SIGCONT);
    });
    for (int i = 0; i < 7; ++i) EXPECT_TRUE(device->try_scan(test::patience));
    hand.join();
    EXPECT_FALSE(device->next_event());
    test::expect_identity(device->counts());
    return device->counts().samples_lost == 0;
  });
}

}  // namespace
}  // namespace g4lidar
