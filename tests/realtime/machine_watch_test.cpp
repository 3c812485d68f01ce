// SPDX-License-Identifier: MIT
// What real-time tests do where the machine stops them: here a child stops the test.
#include "support/machine_watch.hpp"

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <functional>
#include <thread>
#include <vector>

#include "support/patience.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;

void be_stopped() {
  const pid_t self = ::getpid();
  const pid_t child = ::fork();
  if (child == 0) {
    ::kill(self, SIGSTOP);
    ::usleep(100'000);
    ::kill(self, SIGCONT);
    ::_exit(0);
  }
  ASSERT_EQ(::waitpid(child, nullptr, 0), child);
}

enum class verdict { passed, failed, skipped };

/// Of a test that does this.
verdict verdict_of(const std::function<void()>& test) {
  testing::TestPartResultArray results;
  {
    const testing::ScopedFakeTestPartResultReporter reporter(
        testing::ScopedFakeTestPartResultReporter::INTERCEPT_ONLY_CURRENT_THREAD, &results);
    test();
  }
  verdict worst = verdict::passed;
  for (int i = 0; i < results.size(); ++i) {
    const testing::TestPartResult& result = results.GetTestPartResult(i);
    if (result.failed()) return verdict::failed;
    if (result.skipped()) worst = verdict::skipped;
  }
  return worst;
}

TEST(MachineWatch, NoticesAStop) {
  const machine_watch machine;
  be_stopped();
  EXPECT_TRUE(machine.was_stopped());
}

// More threads than processors, none of which sleeps.
TEST(MachineWatch, NoticesAWaitForAProcessor) {
  const machine_watch machine;
  std::atomic<bool> is_over = false;
  std::vector<std::thread> busy;
  for (unsigned i = 0; i < 4 * std::max(1U, std::thread::hardware_concurrency()); ++i) {
    busy.emplace_back([&is_over] {
      while (!is_over) {
      }
    });
  }
  EXPECT_TRUE(comes_true([&] { return machine.was_stopped(); }));
  is_over = true;
  for (std::thread& each : busy) each.join();
}

TEST(MachineWatch, RunsThatTakeTooLongWhileItStops_AreRepeated) {
  int runs = 0;
  const auto measure = [&] {
    if (++runs > 2) return 1ms;
    be_stopped();
    return 100ms;
  };
  EXPECT_EQ(verdict_of([&] { expect_percentile_below(50ms, 100, 3, measure); }), verdict::passed);
  EXPECT_EQ(runs, 5);
}

TEST(MachineWatch, ATestThatIsStoppedEachTime_IsSkipped) {
  int runs = 0;
  const auto measure = [&] {
    ++runs;
    be_stopped();
    return 100ms;
  };
  EXPECT_EQ(verdict_of([&] { expect_percentile_below(50ms, 100, 3, measure); }), verdict::skipped);
  EXPECT_EQ(runs, 3);
  runs = 0;
  const auto attempt = [&] { return measure() < 50ms; };
  EXPECT_EQ(verdict_of([&] { expect_three_of_four(attempt); }), verdict::skipped);
  EXPECT_EQ(runs, 4);
}

TEST(MachineWatch, WhatIsQuickEnough_PassesAlthoughItIsStopped) {
  const auto measure = [] {
    be_stopped();
    return 10ms;
  };
  EXPECT_EQ(verdict_of([&] { expect_percentile_below(50ms, 100, 2, measure); }), verdict::passed);
}

TEST(MachineWatch, WhatIsTooSlowWithoutAStop_Fails) {
  const machine_watch machine;
  const auto percentile =
      verdict_of([] { expect_percentile_below(50ms, 100, 3, [] { return 100ms; }); });
  const auto attempts = verdict_of([] { expect_three_of_four([] { return false; }); });
  if (machine.was_stopped()) GTEST_SKIP() << machine_was_stopped;
  EXPECT_EQ(percentile, verdict::failed);
  EXPECT_EQ(attempts, verdict::failed);
}

}  // namespace
}  // namespace g4lidar::test
