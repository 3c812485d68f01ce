// SPDX-License-Identifier: MIT
// The largest and least times, pauses of years, and moved-from writers and readers.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <limits>
#include <thread>

#include "g4lidar/recording/reader.hpp"
#include "made_recording.hpp"
#include "recorded_run.hpp"
#include "support/patience.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;
using clock = std::chrono::steady_clock;

constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t least = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t year = 365 * 24 * 3600 * second;

TEST(ExtremeTimes, Writer_AcceptsAnyTime_ReaderContinues) {
  for (const std::int64_t ahead_ns : {least, std::int64_t{0}, most}) {
    const temporary_path path;
    auto writer = recording_writer::create(path.text(), {.rotate_time = 1s});
    ASSERT_TRUE(writer);
    writer->set_wall_clock(ahead_ns);
    for (const std::int64_t time_ns : {std::int64_t{5}, most, least, std::int64_t{-1}}) {
      writer->from_device(reading(0), time_ns);
      writer->event({.what = recorded_event::kind::cut, .time_ns = time_ns});
      writer->scan({});
    }
    EXPECT_TRUE(writer->close());
    if (auto reader = recording_reader::open(path.text(), {.from_ns = least, .to_ns = most})) {
      while (const auto item = reader->next()) {
        if (!*item) break;
      }
    }
  }
}

/// A recording whose second half is `later_ns` later.
void record_jump(const std::string& path, std::int64_t later_ns) {
  auto writer = made_writer(path);
  for (std::uint32_t i = 0; i < 4; ++i) {
    writer.from_device(reading(i), time_of(i) + (i < 2 ? 0 : later_ns));
  }
}

/// Reads until its end, or for 100 calls.
std::vector<problem> errors_of(lidar& device) {
  std::vector<problem> found;
  for (int i = 0; i < 100; ++i) {
    const auto got = device.next_points(20ms);
    if (got) continue;
    found.push_back(got.error().code());
    if (got.error().is_fatal()) break;
  }
  return found;
}

TEST(ExtremeTimes, JumpOfYears_IsPlayedWithoutWaiting) {
  const temporary_path path;
  record_jump(path.text(), 40 * year);
  auto device = lidar::open(std::move(*replay::open(path.text())));
  ASSERT_TRUE(device);
  ASSERT_TRUE(device->start());
  const auto errors = errors_of(*device);
  ASSERT_FALSE(errors.empty());
  EXPECT_EQ(errors.back(), problem::end_of_input);
}

struct slow_replay {
  std::int64_t jump_ns;
  double rate;
};

class SlowReplay : public testing::TestWithParam<slow_replay> {};

TEST_P(SlowReplay, ReturnsByTheTimeout_IsWokenAndReported) {
  const temporary_path path;
  record_jump(path.text(), GetParam().jump_ns);
  auto device = lidar::open(std::move(*replay::open(path.text(), {.speed = GetParam().rate})));
  ASSERT_TRUE(device);
  ASSERT_TRUE(device->start());
  const auto begin = clock::now();
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(device->try_scan(20ms).error().code(), problem::timeout);
  }
  EXPECT_LT(clock::now() - begin, test::patience) << "that would be years";
  std::thread waker([&] {
    std::this_thread::sleep_for(20ms);
    device->wake();
  });
  EXPECT_EQ(device->try_scan(std::chrono::milliseconds::max()).error().code(), problem::cancelled);
  waker.join();
  const auto event = device->next_event();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->what, lidar_event::kind::long_pause);
  EXPECT_FALSE(device->next_event()) << "once";
}

INSTANTIATE_TEST_SUITE_P(All, SlowReplay,
                         testing::Values(slow_replay{year, 1.0}, slow_replay{40 * year, 1000.0},
                                         slow_replay{10 * second, 1e-6},
                                         slow_replay{40 * year, 1e-6}));

TEST(MovedFrom, Writer_BehavesAsClosed) {
  const temporary_path path;
  auto first = made_writer(path.text());
  recording_writer second = std::move(first);
  first.from_device(reading(0), 1);  // NOLINT(bugprone-use-after-move): this is tested
  first.to_device(reading(0), 1);
  first.event({.what = recorded_event::kind::cut});
  first.scan({});
  first.points({});
  first.device({});
  first.set_wall_clock(0);
  EXPECT_TRUE(first.flush());
  EXPECT_TRUE(first.close());
  EXPECT_FALSE(first.take_error());
  EXPECT_EQ(first.counts().readings, 0U);
  EXPECT_EQ(first.digest().point_count, 0U);
  EXPECT_EQ(first.path(), "");
  virtual_bench bench;
  auto from = recorded(std::make_unique<virtual_connector>(bench), first);
  ASSERT_TRUE(from);
  EXPECT_TRUE(lidar::open(std::move(*from)));
  first = std::move(second);
  EXPECT_EQ(first.path(), path.text());
}

TEST(MovedFrom, Reader_IsAtItsEnd) {
  const temporary_path path;
  {
    auto writer = made_writer(path.text());
    record_readings(writer, 0, 3);
  }
  auto first = recording_reader::open(path.text());
  ASSERT_TRUE(first);
  const recording_reader second = std::move(*first);
  const auto next = first->next();
  ASSERT_TRUE(next);
  EXPECT_FALSE(*next);
  EXPECT_FALSE(first->device());
  EXPECT_FALSE(first->digest());
  EXPECT_EQ(first->first_ns(), 0);
  EXPECT_EQ(first->last_ns(), 0);
  EXPECT_FALSE(first->damage().any());
  EXPECT_EQ(first->position(), 0U);
  EXPECT_EQ(first->size(), 0U);
}

}  // namespace
}  // namespace g4lidar::test
