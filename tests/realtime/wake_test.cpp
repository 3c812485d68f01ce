// SPDX-License-Identifier: MIT
// Waiting calls are ended from elsewhere; the background reader ends in any order of calls.
#include <gtest/gtest.h>
#include <pthread.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "g4lidar/background_reader.hpp"
#include "realtime/device_on_pty.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using test::comes_true;
using test::device_on_pty;
using clock = std::chrono::steady_clock;

/// The outcome of a long wait for a revolution that does not arrive.
result<scan> wait_for_nothing(lidar& device) {
  while (true) {
    auto scan = device.try_scan(10min);
    if (!scan) return scan;
  }
}

/// It answers, and its motor does not move for ten minutes.
sim::device_options lazy_g4() {
  auto options = test::quick_g4();
  options.standstill_ns = 60'000'000'000;
  return options;
}

TEST(Wake, EndsAWaitFromAnotherThread) {
  device_on_pty simulated(lazy_g4());
  auto device = lidar::open(test::patient_options(simulated.path()));
  ASSERT_TRUE(device) << device.error().message();
  ASSERT_TRUE(device->start());
  const auto begin = clock::now();
  std::thread other([&] {
    std::this_thread::sleep_for(200ms);
    device->wake();
  });
  const auto ended = wait_for_nothing(*device);
  EXPECT_EQ(ended.error().code(), problem::cancelled) << ended.error().message();
  EXPECT_GE(clock::now() - begin, 200ms);
  EXPECT_LT(clock::now() - begin, test::patience);
  other.join();
  EXPECT_EQ(device->try_scan(10ms).error().code(), problem::timeout);  // once
}

std::atomic<lidar*> to_wake = nullptr;
extern "C" void wake_it(int) {
  if (lidar* const device = to_wake) device->wake();
}

TEST(Wake, EndsAWaitFromASignalHandler) {
  struct sigaction action{};
  action.sa_handler = wake_it;
  struct sigaction before{};
  ASSERT_EQ(::sigaction(SIGUSR2, &action, &before), 0);
  device_on_pty simulated;
  auto device = lidar::open(test::patient_options(simulated.path()));
  ASSERT_TRUE(device) << device.error().message();
  ASSERT_TRUE(device->start());
  to_wake = &*device;
  const pthread_t reader = ::pthread_self();
  std::thread other([&] {
    std::this_thread::sleep_for(100ms);
    ::pthread_kill(reader, SIGUSR2);
  });
  const auto ended = wait_for_nothing(*device);
  EXPECT_EQ(ended.error().code(), problem::cancelled) << ended.error().message();
  other.join();
  to_wake = nullptr;
  ::sigaction(SIGUSR2, &before, nullptr);
  EXPECT_TRUE(device->try_scan(test::patience));
}

// Also while transports are opened and closed: a handler that interrupts that finds everything
// locked.
TEST(Wake, ManyFromASignalHandler_DelayNothing) {
  struct sigaction action{};
  action.sa_handler = wake_it;
  struct sigaction before{};
  ASSERT_EQ(::sigaction(SIGUSR2, &action, &before), 0);
  device_on_pty simulated;
  lidar_options options;
  options.device = simulated.path();
  options.reconnect = true;
  auto device = lidar::open(options);
  ASSERT_TRUE(device) << device.error().message();
  to_wake = &*device;
  std::atomic<bool> over = false;
  const pthread_t reader = ::pthread_self();
  std::thread storm([&] {
    while (!over) {
      ::pthread_kill(reader, SIGUSR2);
      std::this_thread::sleep_for(300us);
    }
  });
  const auto does = [](auto&& work) {
    const auto end = clock::now() + test::patience;
    while (clock::now() < end) {
      if (work()) return true;
    }
    return false;
  };
  EXPECT_TRUE(does([&] { return device->start().has_value(); }));
  for (std::uint64_t plugs = 1; plugs <= 3; ++plugs) {
    simulated.unplug();
    std::this_thread::sleep_for(20ms);
    simulated.replug();
    EXPECT_TRUE(does([&] {
      static_cast<void>(device->try_scan(100ms));
      return device->counts().reconnects >= plugs;
    }));
    EXPECT_TRUE(does([&] { return device->try_scan(100ms).has_value(); }));
  }
  EXPECT_TRUE(does([&] {
    return device->ask(requests::health(), while_scanning::stop_and_resume).has_value();
  }));
  EXPECT_TRUE(does([&] { return device->stop().has_value(); }));
  EXPECT_TRUE(does([&] { return device->start().has_value(); }));
  static_cast<void>(device->close());
  EXPECT_TRUE(simulated.becomes_idle_and_silent());
  over = true;
  storm.join();
  to_wake = nullptr;
  ::sigaction(SIGUSR2, &before, nullptr);
}

TEST(Wake, StartAndStop_AreCompleted) {
  device_on_pty simulated;
  auto device = lidar::open(test::patient_options(simulated.path()));
  ASSERT_TRUE(device) << device.error().message();
  for (int i = 0; i < 3; ++i) {
    device->wake();
    EXPECT_EQ(device->start().error().code(), problem::cancelled);
    ASSERT_TRUE(device->start());
    device->wake();
    EXPECT_EQ(device->stop().error().code(), problem::cancelled);
    ASSERT_TRUE(device->stop());
  }
  EXPECT_EQ(device->counts().command_retries, 0U);
  EXPECT_TRUE(simulated.becomes_idle_and_silent());
}

TEST(BackgroundReaderOnPty, ServesReadersInOtherThreads) {
  device_on_pty simulated;
  auto device = lidar::open(test::patient_options(simulated.path()));
  ASSERT_TRUE(device) << device.error().message();
  auto reader = background_reader::start(std::move(*device));
  ASSERT_TRUE(reader) << reader.error().message();
  const auto consume = [&] {
    auto points = reader->points().make_reader();
    std::vector<point> some(512);
    std::uint64_t seen = 0;
    std::uint64_t missed = 0;
    EXPECT_TRUE(comes_true([&] {
      const ring_read read = points.read(some);
      seen += read.points;
      missed += read.missed;
      return seen > 9'000;
    }));
    EXPECT_EQ(missed, 0U);
  };
  std::thread other(consume);
  consume();
  other.join();
  reader->stop();
  // The motor is stopped while the reader still exists.
  EXPECT_TRUE(simulated.becomes_idle_and_silent());
  EXPECT_FALSE(reader->failed());
  test::expect_identity(reader->counts());
}

// The 90th percentile of 20 runs: other programs may delay a few of them.
TEST(BackgroundReaderOnPty, Unplug_IsReportedImmediately) {
  test::expect_percentile_below(100ms, 90, 20, [] {
    device_on_pty simulated;
    auto device = lidar::open(test::patient_options(simulated.path()));
    EXPECT_TRUE(device) << device.error().message();
    auto reader = background_reader::start(std::move(*device));
    EXPECT_TRUE(reader) << reader.error().message();
    const auto pulled = simulated.unplug();
    EXPECT_TRUE(comes_true([&] { return reader->failed().has_value(); }));
    const auto known = clock::now();
    EXPECT_EQ(reader->failed()->code(), problem::gone);
    return known - pulled;
  });
}

TEST(BackgroundReaderOnPty, EndsInAnyOrder) {
  for (int i = 0; i < 12; ++i) {
    auto simulated = std::make_unique<device_on_pty>();
    auto device = lidar::open(simulated->path());
    ASSERT_TRUE(device) << device.error().message();
    auto begun = background_reader::start(std::move(*device));
    ASSERT_TRUE(begun) << begun.error().message();
    auto reader = std::make_unique<background_reader>(std::move(*begun));
    std::this_thread::sleep_for(i * 7ms);
    switch (i % 4) {
      case 0:  // stopped by several at once, then destroyed
      {
        std::thread other([&] { reader->stop(); });
        reader->stop();
        other.join();
        EXPECT_TRUE(simulated->becomes_idle_and_silent()) << i;
        break;
      }
      case 1:  // destroyed
        reader.reset();
        EXPECT_TRUE(simulated->becomes_idle_and_silent()) << i;
        break;
      case 2:  // the device is unplugged first
        simulated.reset();
        break;
      default:  // both at once
      {
        std::thread other([&] { simulated.reset(); });
        reader.reset();
        other.join();
      }
    }
  }
}

TEST(BackgroundReaderOnPty, EndsWhileItReconnects) {
  device_on_pty simulated;
  lidar_options options;
  options.device = simulated.path();
  options.reconnect = true;
  auto device = lidar::open(options);
  ASSERT_TRUE(device) << device.error().message();
  auto reader = background_reader::start(std::move(*device));
  ASSERT_TRUE(reader) << reader.error().message();
  simulated.unplug();
  ASSERT_TRUE(comes_true([&] {
    const auto event = reader->next_event();
    return event && event->what == lidar_event::kind::lost;
  }));
  std::this_thread::sleep_for(100ms);
  const auto begin = clock::now();
  reader->stop();
  EXPECT_LT(clock::now() - begin, test::patience);
  EXPECT_FALSE(reader->failed());
}

}  // namespace
}  // namespace g4lidar
