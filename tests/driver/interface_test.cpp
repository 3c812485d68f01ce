// SPDX-License-Identifier: MIT
// The interface for applications: the range of scans, typed requests, options, extreme values, and
// a moved-from lidar.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <iterator>
#include <limits>
#include <ranges>
#include <string>
#include <type_traits>
#include <utility>

#include "g4lidar/g4lidar.hpp"
#include "support/virtual_transport.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using std::chrono::milliseconds;
using test::open_virtual;
using test::virtual_bench;

constexpr std::int64_t ms = 1'000'000;
static_assert(std::ranges::input_range<scan_range>);

TEST(ScanRange, EndsWithTheErrorOfAnUnplug) {
  const sim::fault faults[] = {sim::make_fault(sim::fault_kind::unplug, 6000 * ms)};
  virtual_bench bench({}, faults);
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->start());
  auto scans = lidar->scans(5s);
  EXPECT_FALSE(scans.why_ended());
  std::uint32_t seen = 0;
  std::uint32_t next = 0;
  for (const scan& one : scans) {
    EXPECT_TRUE(seen++ == 0 || one.revolution == next);
    next = one.revolution + 1;
  }
  EXPECT_GT(seen, 20U);
  EXPECT_EQ(seen, lidar->counts().scans);
  ASSERT_TRUE(scans.why_ended());
  EXPECT_EQ(*scans.why_ended(), problem::gone);
}

TEST(ScanRange, EndsAtATimeoutAndContinuesInAnotherLoop) {
  virtual_bench bench;
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->start());
  auto scans = lidar->scans(0ms);
  std::uint64_t seen = 0;
  for ([[maybe_unused]] const scan& one : scans) ++seen;
  EXPECT_EQ(seen, 1U) << "the spin-up is waited for, and then the next revolution is not complete";
  ASSERT_TRUE(scans.why_ended());
  EXPECT_EQ(*scans.why_ended(), problem::timeout);
  for ([[maybe_unused]] const scan& one : lidar->scans(5s)) lidar->wake();
  EXPECT_EQ(lidar->counts().scans, 2U);
}

TEST(ScanRange, NotStarted_IsEmpty) {
  virtual_bench bench;
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  auto scans = lidar->scans(1s);
  EXPECT_EQ(std::ranges::distance(scans.begin(), scans.end()), 0);
  EXPECT_EQ(*scans.why_ended(), problem::not_scanning);
}

TEST(TypedRequests, ReturnTheTypeOfTheirAnswer) {
  sim::device_options options;
  options.condition = {health_status::warning, 0x1234};
  virtual_bench bench(options);
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  const result<health> reply = lidar->ask(requests::health());
  ASSERT_TRUE(reply);
  EXPECT_EQ(*reply, (health{health_status::warning, 0x1234}));
  const result<device_information> who = lidar->ask(requests::device_info());
  ASSERT_TRUE(who);
  EXPECT_EQ(*who, lidar->information());
  const result<void> restarted = lidar->ask(requests::restart());
  EXPECT_TRUE(restarted);
  static_assert(!std::is_convertible_v<result<device_information>, result<health>>);
}

TEST(Settings, AreSetAndReadBack) {
  virtual_bench bench;
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  const result<scan_frequency> frequency = lidar->set(scan_frequency::hz(10));
  ASSERT_TRUE(frequency);
  EXPECT_EQ(frequency->chz, 1000);
  EXPECT_EQ(bench.device.settings().scan_frequency_chz, 1000);
  EXPECT_EQ(lidar->ask(requests::get_scan_frequency()).value(), scan_frequency::hz(10));
  EXPECT_EQ(lidar->set(sample_rate::khz_4).value(), sample_rate::khz_4);
  EXPECT_EQ(lidar->set(motor_direction::counter_clockwise).value(),
            motor_direction::counter_clockwise);
}

TEST(Settings, FrequencyInHertz_IsRoundedAndNeverWraps) {
  static_assert(scan_frequency::hz(7.5).chz == 750);
  static_assert(scan_frequency::hz(6.994).chz == 699);
  static_assert(scan_frequency::hz(6.996).chz == 700);
  static_assert(scan_frequency::hz(-1).chz == 0);
  static_assert(scan_frequency::hz(1e300).chz == 65535);
  static_assert(scan_frequency::hz(662.0).chz == 65535);  // not 664
  EXPECT_EQ(scan_frequency::hz(std::numeric_limits<double>::quiet_NaN()).chz, 0);
  EXPECT_EQ(scan_frequency{1050}.hz(), 10.5);
}

TEST(Options, InvalidEnumerators_AreRefused) {
  const auto refused = [](auto&& change) {
    lidar_options options;
    change(options);
    const auto wrong = problem_with(options);
    return wrong ? std::string(wrong->subject().substr(0, wrong->subject().find(':'))) : "nothing";
  };
  EXPECT_EQ(refused([](auto& o) { o.sample_rate = sample_rate{77}; }), "sample_rate");
  EXPECT_EQ(refused([](auto& o) { o.sample_rate = sample_rate{3}; }), "sample_rate");
  EXPECT_EQ(refused([](auto& o) { o.direction = motor_direction{77}; }), "direction");
  EXPECT_EQ(refused([](auto& o) { o.constant = constant_frequency{2}; }), "constant");
  EXPECT_EQ(refused([](auto& o) { o.idle = low_power{77}; }), "idle");
  EXPECT_EQ(refused([](auto& o) { o.protection = power_down_protection{77}; }), "protection");
  EXPECT_EQ(refused([](auto& o) { o.frequency = scan_frequency::hz(15); }), "frequency");
  EXPECT_EQ(refused([](auto& o) { o.sample_rate = sample_rate::khz_9; }), "nothing");
}

TEST(Options, AnImpossibleValue_IsRepeated) {
  const auto subject_of = [](auto change) {
    lidar_options options;
    change(options);
    const auto wrong = problem_with(options);
    return wrong ? std::string(wrong->subject()) : "nothing";
  };
  EXPECT_EQ(subject_of([](lidar_options& o) { o.tuning.answer_time = 9ms; }),
            "answer_time: 10 ms to 10 s, not 9 ms");
  EXPECT_EQ(subject_of([](lidar_options& o) { o.tuning.stall_time = -1ms; }),
            "stall_time: 100 ms to 1 min, not -1 ms");
  EXPECT_EQ(subject_of([](lidar_options& o) { o.tuning.batch = milliseconds::max(); }),
            "batch: 0 to 100 ms, not 4294967295 ms");
  EXPECT_EQ(subject_of([](lidar_options& o) { o.tuning.transport_delay = 1'000'000'001ns; }),
            "transport_delay: 0 to 1 s, not 1000000001 ns");
  EXPECT_EQ(subject_of([](lidar_options& o) { o.frequency = scan_frequency{1300}; }),
            "frequency: 500 to 1200 (5 to 12 Hz of a G4), not 1300");
}

TEST(ExtremeTimeouts, AreLimited) {
  virtual_bench bench;
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->start());
  const std::int64_t before_ns = bench.now_ns;
  EXPECT_EQ(lidar->try_scan(milliseconds::min()).error(), problem::timeout);
  EXPECT_LT(bench.now_ns - before_ns, 100 * ms);
  EXPECT_TRUE(lidar->try_scan(milliseconds::max()));
  EXPECT_TRUE(lidar->next_points(milliseconds::max()));
  while (lidar->next_points(milliseconds::min())) {  // ends when the available points are taken
  }
}

TEST(MovedFromLidar, BehavesAsClosed) {
  virtual_bench bench;
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  const g4lidar::lidar taken = std::move(*lidar);
  g4lidar::lidar& empty = *lidar;
  EXPECT_EQ(empty.start().error(), problem::gone);
  EXPECT_EQ(empty.stop().error(), problem::gone);
  EXPECT_TRUE(empty.close());
  empty.release();
  EXPECT_EQ(empty.try_scan(1s).error(), problem::gone);
  EXPECT_EQ(empty.next_points(1s).error(), problem::gone);
  EXPECT_EQ(empty.event_loop().process().error(), problem::gone);
  EXPECT_EQ(empty.ask(requests::health()).error(), problem::gone);
  EXPECT_EQ(empty.set(low_power::on).error(), problem::gone);
  empty.wake();
  EXPECT_EQ(empty.event_loop().native_handle(), -1);
  EXPECT_EQ(empty.event_loop().next_deadline(), std::chrono::steady_clock::time_point::max());
  EXPECT_EQ(empty.points().written(), 0U);
  EXPECT_EQ(empty.information(), device_information{});
  EXPECT_EQ(empty.name(), "closed");
  EXPECT_FALSE(empty.is_scanning());
  EXPECT_EQ(empty.counts().bytes, 0U);
  EXPECT_FALSE(empty.next_event());
  auto scans = empty.scans(1s);
  EXPECT_EQ(scans.begin(), scans.end());
  EXPECT_EQ(taken.name(), "virtual");
}

TEST(Deadline, IsTheSameAsATimePoint) {
  virtual_bench bench;
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->start());
  ASSERT_TRUE(lidar->try_scan(5s));
  EXPECT_EQ(lidar->event_loop().next_deadline().time_since_epoch() / 1ns,
            lidar->event_loop().next_deadline_ns());
}

/// The documented time, with each kind of fault long before the stop, and shortly before.
TEST(Stop, KeepsItsDocumentedTime) {
  std::int64_t longest_ns = 0;
  for (int i = 0; i <= static_cast<int>(sim::last_fault_kind); ++i) {
    const auto kind = static_cast<sim::fault_kind>(i);
    for (const std::int64_t at_ns : {4000 * ms, 4050 * ms, 8000 * ms}) {
      const sim::fault faults[] = {sim::make_fault(kind, at_ns)};
      virtual_bench bench({}, faults);
      auto lidar = open_virtual(bench);
      if (!lidar || !lidar->start()) continue;
      while (bench.now_ns < 8000 * ms && lidar->try_scan(500ms)) {
      }
      const std::int64_t before_ns = bench.now_ns;
      static_cast<void>(lidar->stop());
      longest_ns = std::max(longest_ns, bench.now_ns - before_ns);
    }
  }
  EXPECT_LE(longest_ns, 1500 * ms);
}

}  // namespace
}  // namespace g4lidar
