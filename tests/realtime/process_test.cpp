// SPDX-License-Identifier: MIT
// The simulated G4 in a program of its own, which is killed and held up: g4-dump sim --link.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <memory>
#include <string>
#include <thread>

#include "realtime/child_process.hpp"
#include "realtime/twin_on_pty.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using clock = std::chrono::steady_clock;

class TwinProgram : public testing::Test {
 protected:
  void begin() {
    program_ = std::make_unique<test::child_process>(
        std::vector<std::string>{G4_DUMP, "sim", "--link", path_}, directory_.file("said"));
    ASSERT_TRUE(program_->says(" at " + path_)) << program_->said();
  }

  test::scratch_directory directory_;
  std::string path_ = directory_.file("g4");
  std::unique_ptr<test::child_process> program_;
};

TEST_F(TwinProgram, KilledIsGone) {
  auto best = clock::duration::max();
  for (int i = 0; i < 3; ++i) {
    begin();
    auto device = lidar::open(path_);
    ASSERT_TRUE(device) << device.error().message();
    ASSERT_TRUE(device->start());
    ASSERT_TRUE(device->next_scan(10s));
    clock::time_point killed;
    std::thread hand([&] {
      std::this_thread::sleep_for(50ms);
      killed = clock::now();
      program_->send(SIGKILL);
    });
    auto scan = device->next_scan(10s);
    while (scan) scan = device->next_scan(10s);
    const auto known = clock::now();
    hand.join();
    EXPECT_EQ(scan.error().what(), problem::gone) << scan.error().message();
    best = std::min(best, known - killed);
    EXPECT_EQ(program_->wait(), 128 + SIGKILL);
  }
  EXPECT_LT(best, 100ms);
}

TEST_F(TwinProgram, KilledAndBegunAgainIsTheSameDevice) {
  begin();
  lidar_options options;
  options.device = path_;
  options.reconnect = true;
  auto device = lidar::open(options);
  ASSERT_TRUE(device) << device.error().message();
  ASSERT_TRUE(device->start());
  ASSERT_TRUE(device->next_scan(10s));
  program_->send(SIGKILL);
  EXPECT_EQ(program_->wait(), 128 + SIGKILL);
  begin();
  const auto end = clock::now() + 20s;
  while (device->counts().reconnects == 0 && clock::now() < end) {
    const auto scan = device->next_scan(100ms);
    if (!scan) {
      ASSERT_FALSE(scan.error().is_fatal()) << scan.error().message();
    }
  }
  EXPECT_EQ(device->counts().reconnects, 1U);
  EXPECT_TRUE(device->next_scan(10s));
}

// As when a laptop sleeps for a moment, or a debugger holds it up: what follows is as before.
TEST_F(TwinProgram, HeldUpForASecondGoesOn) {
  begin();
  lidar_options options;
  options.device = path_;
  options.reconnect = true;
  auto device = lidar::open(options);
  ASSERT_TRUE(device) << device.error().message();
  ASSERT_TRUE(device->start());
  ASSERT_TRUE(device->next_scan(10s));
  program_->send(SIGSTOP);
  std::thread hand([&] {
    std::this_thread::sleep_for(1s);
    program_->send(SIGCONT);
  });
  int scans = 0;
  const auto end = clock::now() + 20s;
  while (scans < 20 && clock::now() < end) {
    const auto scan = device->next_scan(100ms);
    if (scan) {
      ++scans;
    } else {
      EXPECT_FALSE(scan.error().is_fatal()) << scan.error().message();
    }
  }
  hand.join();
  EXPECT_EQ(scans, 20);
  test::expect_identity(device->counts());
}

// Where nobody asked for reconnecting either, a second of silence is no reason to give up.
TEST_F(TwinProgram, HeldUpForHalfASecondIsNotEvenAnEvent) {
  begin();
  lidar_options options;
  options.device = path_;
  options.stall_time = 10s;
  auto device = lidar::open(options);
  ASSERT_TRUE(device) << device.error().message();
  ASSERT_TRUE(device->start());
  ASSERT_TRUE(device->next_scan(10s));
  program_->send(SIGSTOP);
  std::thread hand([&] {
    std::this_thread::sleep_for(500ms);
    program_->send(SIGCONT);
  });
  for (int i = 0; i < 10; ++i) {
    const auto scan = device->next_scan(10s);
    ASSERT_TRUE(scan) << scan.error().message();
    EXPECT_TRUE(scan->is_whole());
  }
  hand.join();
  EXPECT_FALSE(device->next_event());
  EXPECT_EQ(device->counts().samples_lost, 0U);
}

}  // namespace
}  // namespace g4lidar
