// SPDX-License-Identifier: MIT
// The reader with a thread of its own.
#include "g4lidar/background_reader.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "g4lidar/transport/transport.hpp"
#include "support/allocation_count.hpp"
#include "support/patience.hpp"
#include "support/virtual_transport.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using test::comes_true;
using test::open_virtual;
using test::virtual_bench;
using test::virtual_connector;

constexpr std::int64_t ms = 1'000'000;

TEST(BackgroundReader, WritesToTheRing) {
  virtual_bench bench;
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  auto reader = background_reader::start(std::move(*lidar));
  ASSERT_TRUE(reader) << reader.error().message();
  auto points = reader->points().make_reader();
  std::vector<point> some(4096);
  std::uint64_t seen = 0;
  EXPECT_TRUE(comes_true([&] {
    const ring_read read = points.read(some);
    seen += read.points + read.missed;
    return seen > 50'000;
  }));
  EXPECT_TRUE(comes_true([&] { return reader->counts().scans > 10; }));
  reader->stop();
  EXPECT_FALSE(reader->failed());
  EXPECT_TRUE(bench.device.is_idle_and_silent(bench.now_ns));
  reader->stop();  // the second call does nothing
}

TEST(BackgroundReader, ProvidesScansAndCountsMissedOnes) {
  virtual_bench bench;
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  auto reader = background_reader::start(std::move(*lidar));
  ASSERT_TRUE(reader);
  std::uint64_t taken = 0;
  std::uint32_t first = 0;
  std::uint32_t last = 0;
  const auto take = [&](const scan& one) {
    if (taken == 0) first = one.revolution;
    EXPECT_TRUE(taken == 0 || one.revolution > last);
    last = one.revolution;
    EXPECT_TRUE(one.is_whole());
    EXPECT_TRUE(one.points.front().is_revolution_start());
    for (const point& p : one.points) EXPECT_EQ(p.revolution, one.revolution);
    ++taken;
  };
  const auto one = reader->next_scan(test::patience);
  ASSERT_TRUE(one) << one.error().message();
  take(*one);
  const std::uint64_t missed_before = reader->counts().scans_missed;
  EXPECT_TRUE(comes_true([&] { return reader->counts().scans_missed > missed_before + 3; }));
  for (const point& p : one->points) ASSERT_EQ(p.revolution, one->revolution) << "was changed";
  for (int i = 0; i < 20; ++i) {
    const auto next = reader->next_scan(test::patience);
    ASSERT_TRUE(next);
    take(*next);
  }
  EXPECT_TRUE(reader->next_scan(lidar::milliseconds::max()));  // not counted in `taken`
  reader->stop();
  const auto rest = reader->next_scan(0s);
  if (rest) take(*rest);
  while (const auto more = reader->next_scan(lidar::milliseconds::max())) take(*more);
  EXPECT_EQ(reader->next_scan(lidar::milliseconds::min()).error(), problem::not_scanning);
  // Each revolution since the first one taken was taken or missed.
  EXPECT_GE(reader->counts().scans_missed + taken + 1, last - first + 1);
  EXPECT_EQ(reader->counts().scans_missed + taken + 1, reader->counts().scans);
}

/// What a test and the thread of the reader share: after so many bytes nothing arrives until the
/// reader is woken.
struct hold_point {
  std::size_t bytes;
  std::atomic<bool> is_reached = false;
};

class held_transport final : public forwarding_transport {
 public:
  held_transport(std::unique_ptr<transport> inner, hold_point& at, virtual_bench& bench)
      : forwarding_transport(std::move(inner)), at_(&at), bench_(&bench) {}

  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override {
    if (seen_ >= at_->bytes && !at_->is_reached) {
      at_->is_reached = true;
      while (!bench_->wake) std::this_thread::sleep_for(1ms);
    }
    const auto got = inner().read(out, deadline_ns);
    if (got) seen_ += got->count;
    return got;
  }

 private:
  hold_point* at_;
  virtual_bench* bench_;
  std::size_t seen_ = 0;
};

class holding_connector final : public forwarding_connector {
 public:
  holding_connector(virtual_bench& bench, hold_point& at)
      : forwarding_connector(std::make_unique<virtual_connector>(bench)),
        bench_(&bench),
        at_(&at) {}

  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override {
    auto made = inner().connect();
    if (!made) return made;
    return std::make_unique<held_transport>(*std::move(made), *at_, *bench_);
  }

 private:
  virtual_bench* bench_;
  hold_point* at_;
};

TEST(BackgroundReader, ProvidesPiecesWithTheirFlags) {
  virtual_bench bench;
  hold_point after{12'000};  // fewer scans than the reader keeps
  lidar_options options;
  options.partial_scans = true;
  auto lidar = lidar::open(std::make_unique<holding_connector>(bench, after), options);
  ASSERT_TRUE(lidar);
  auto reader = background_reader::start(std::move(*lidar));
  ASSERT_TRUE(reader);
  ASSERT_TRUE(comes_true([&] { return after.is_reached.load(); }));
  reader->stop();
  std::vector<scan_flags> flags;
  std::uint64_t points = 0;
  while (const auto one = reader->next_scan(0s)) {
    flags.push_back(one->flags);
    points += one->size();
  }
  using enum scan_flags;
  EXPECT_EQ(flags, (std::vector{start_missing, none, end_missing}));
  EXPECT_EQ(points, reader->counts().stream.points);
  EXPECT_EQ(reader->counts().partial_scans, 2U);
  EXPECT_EQ(reader->counts().scans_missed, 0U);
}

TEST(BackgroundReader, AllocatesNothingWhileItStreams) {
  virtual_bench bench;
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  auto reader = background_reader::start(std::move(*lidar));
  ASSERT_TRUE(reader);
  ASSERT_TRUE(reader->next_scan(test::patience));
  const std::size_t calls = test::allocations_in([&] {
    for (int i = 0; i < 50; ++i) static_cast<void>(reader->next_scan(test::patience));
  });
  EXPECT_EQ(calls, 0U);
}

TEST(BackgroundReader, MovedFrom_BehavesAsStopped) {
  virtual_bench bench;
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  auto reader = background_reader::start(std::move(*lidar));
  ASSERT_TRUE(reader);
  const background_reader taken = std::move(*reader);
  reader->stop();
  EXPECT_EQ(reader->next_scan(test::patience).error(), problem::gone);
  EXPECT_EQ(reader->points().written(), 0U);
  ASSERT_TRUE(reader->failed());
  EXPECT_EQ(*reader->failed(), problem::gone);
  EXPECT_EQ(reader->counts().bytes, 0U);
  EXPECT_FALSE(reader->next_event());
  EXPECT_FALSE(taken.failed());
}

TEST(BackgroundReader, DestroyedAtAnyMoment_Ends) {
  for (int i = 0; i < 20; ++i) {
    virtual_bench bench;
    {
      auto lidar = open_virtual(bench);
      ASSERT_TRUE(lidar);
      auto reader = background_reader::start(std::move(*lidar));
      ASSERT_TRUE(reader);
      std::this_thread::sleep_for(std::chrono::microseconds(100 * i));
      background_reader moved = std::move(*reader);
      *reader = std::move(moved);
    }
    EXPECT_TRUE(bench.device.is_idle_and_silent(bench.now_ns)) << i;
  }
}

TEST(BackgroundReader, Failed_HasTheError) {
  const sim::fault faults[] = {sim::make_fault(sim::fault_kind::unplug, 4000 * ms)};
  virtual_bench bench({}, faults);
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  auto reader = background_reader::start(std::move(*lidar));
  ASSERT_TRUE(reader);
  ASSERT_TRUE(comes_true([&] { return reader->failed().has_value(); }));
  EXPECT_EQ(reader->failed()->code(), problem::gone);
  while (reader->next_scan(test::patience)) {  // earlier scans
  }
  EXPECT_EQ(reader->next_scan(test::patience).error(), problem::gone);
  const auto event = reader->next_event();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->what, lidar_event::kind::lost);
}

/// A lidar that is unplugged for so long.
struct unplugged_bench : virtual_bench {
  explicit unplugged_bench(std::int64_t outage_ns)
      : virtual_bench({},
                      std::array{sim::make_fault(sim::fault_kind::unplug, 4000 * ms, outage_ns)}) {}
};

/// A reader that has just lost it and reconnects.
background_reader reconnecting(unplugged_bench& bench) {
  lidar_options options;
  options.reconnect = true;
  auto lidar = open_virtual(bench, options);
  EXPECT_TRUE(lidar);
  auto reader = background_reader::start(std::move(*lidar));
  EXPECT_TRUE(reader);
  EXPECT_TRUE(comes_true([&] { return reader->next_event().has_value(); }));
  return *std::move(reader);
}

TEST(BackgroundReader, StopsDuringAReconnect) {
  for (int i = 0; i < 20; ++i) {
    unplugged_bench bench(sim::forever_ns);
    background_reader reader = reconnecting(bench);
    std::this_thread::sleep_for(std::chrono::microseconds(100 * i));
    reader.stop();
    EXPECT_FALSE(reader.failed());
    EXPECT_EQ(reader.counts().reconnects, 0U);
  }
}

TEST(BackgroundReader, DestroyedDuringAReconnect_Ends) {
  for (int i = 0; i < 20; ++i) {
    unplugged_bench bench(sim::forever_ns);
    const background_reader reader = reconnecting(bench);
    std::this_thread::sleep_for(std::chrono::microseconds(100 * i));
    EXPECT_EQ(reader.counts().reconnects, 0U);
  }
}

TEST(BackgroundReader, ReplacedDuringAReconnect_Ends) {
  for (int i = 0; i < 20; ++i) {
    unplugged_bench bench(sim::forever_ns);
    unplugged_bench other(sim::forever_ns);
    background_reader reader = reconnecting(bench);
    reader = reconnecting(other);
    EXPECT_FALSE(reader.failed());
    EXPECT_EQ(reader.next_scan(lidar::milliseconds::min()).has_value(), true) << "of the other one";
  }
}

TEST(BackgroundReader, MovedDuringAReconnect_Reconnects) {
  unplugged_bench bench(3'600'000 * ms);
  background_reader reader = reconnecting(bench);
  background_reader moved = std::move(reader);
  EXPECT_EQ(moved.counts().reconnects, 0U) << "it was to be moved before that";
  EXPECT_TRUE(comes_true([&] { return moved.counts().reconnects == 1; }));
  EXPECT_TRUE(comes_true([&] { return moved.next_scan(1s).has_value(); }));
  EXPECT_FALSE(moved.failed());
}

TEST(BackgroundReader, StartFails_HasTheError) {
  sim::device_options sick;
  sick.condition = {health_status::error, 7};
  virtual_bench bench(sick);
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  const auto reader = background_reader::start(std::move(*lidar));
  ASSERT_FALSE(reader);
  EXPECT_EQ(reader.error().code(), problem::unhealthy);
}

/// The time of `start` on a lidar that receives nothing from a time on at which it is open and not started.
template <class Start>
std::int64_t time_of_failed(Start&& start) {
  virtual_bench healthy;
  EXPECT_TRUE(open_virtual(healthy));
  const sim::fault faults[] = {sim::make_fault(sim::fault_kind::deaf, healthy.now_ns + ms)};
  virtual_bench bench({}, faults);
  auto lidar = open_virtual(bench);
  EXPECT_TRUE(lidar);
  const std::int64_t before_ns = bench.now_ns;
  if (lidar) start(*lidar);
  return bench.now_ns - before_ns;
}

TEST(BackgroundReader, FailedStart_TakesAsLongAsThatOfTheLidar) {
  const std::int64_t alone_ns = time_of_failed([](lidar& it) { EXPECT_FALSE(it.start()); });
  const std::int64_t with_thread_ns =
      time_of_failed([](lidar& it) { EXPECT_FALSE(background_reader::start(std::move(it))); });
  EXPECT_EQ(with_thread_ns, alone_ns);
}

}  // namespace
}  // namespace g4lidar
