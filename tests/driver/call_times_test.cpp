// SPDX-License-Identifier: MIT
// The longest times of open(), start() and stop() with one fault, as lidar.hpp states them.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <string>

#include "g4lidar/lidar.hpp"
#include "support/virtual_transport.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using test::open_virtual;
using test::virtual_bench;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t opening_ns = 1000 * ms;  // when a virtual_bench begins

/// The longest time of a call, and the fault with which it took that.
class longest_call {
 public:
  explicit longest_call(const char* name) : name_(name) {}
  template <class Call>
  auto measure(const virtual_bench& bench, const sim::fault& fault, Call&& call) {
    const std::int64_t before_ns = bench.now_ns;
    auto done = call();
    if (bench.now_ns - before_ns > longest_ns_) {
      longest_ns_ = bench.now_ns - before_ns;
      fault_ = fault;
    }
    return done;
  }
  void expect_between(std::int64_t least_ns, std::int64_t most_ns) const {
    const std::string which = std::string(name_) + " with " +
                              std::string(sim::name_of(fault_.kind)) + " at " +
                              std::to_string(fault_.begin_ns / ms) + " ms for " +
                              std::to_string(fault_.duration_ns / ms) + " ms";
    EXPECT_LE(longest_ns_, most_ns) << which;
    EXPECT_GE(longest_ns_, least_ns) << "no fault has struck where it delays most; " << which;
  }

 private:
  const char* name_;
  std::int64_t longest_ns_ = 0;
  sim::fault fault_{};
};

/// Each kind of fault, beginning at each of these times: permanent, or over while the driver still tries.
/// Not `baud`, which damages every byte: that has a limit of its own.
template <class Work>
void for_each_fault(std::int64_t from_ns, std::int64_t to_ns, std::int64_t step_ns, Work work) {
  for (int i = 0; i <= static_cast<int>(sim::last_fault_kind); ++i) {
    const auto kind = static_cast<sim::fault_kind>(i);
    if (kind == sim::fault_kind::baud) continue;
    for (const std::int64_t duration_ns : {sim::forever_ns, 1000 * ms}) {
      for (std::int64_t at_ns = from_ns; at_ns <= to_ns; at_ns += step_ns) {
        work(sim::make_fault(kind, at_ns, duration_ns));
      }
    }
  }
}

/// When a healthy device was open, and when it was started.
struct healthy_times {
  std::int64_t opened_ns;
  std::int64_t started_ns;
};
healthy_times times_without_fault(const lidar_options& options) {
  virtual_bench bench;
  auto lidar = open_virtual(bench, options);
  const std::int64_t opened_ns = bench.now_ns;
  EXPECT_TRUE(lidar && lidar->start());
  return {opened_ns, bench.now_ns};
}

/// The longest start() with a fault that begins during it, `step_ns` apart.
void measure_starts(const lidar_options& options, std::int64_t step_ns, longest_call& starts) {
  const healthy_times healthy = times_without_fault(options);
  for_each_fault(healthy.opened_ns, healthy.started_ns, step_ns, [&](const sim::fault& fault) {
    virtual_bench bench({}, {&fault, 1});
    auto lidar = open_virtual(bench, options);
    if (lidar) static_cast<void>(starts.measure(bench, fault, [&] { return lidar->start(); }));
  });
}

TEST(CallTimes, Open) {
  longest_call opens("open()");
  const std::int64_t opened_ns = times_without_fault({}).opened_ns;
  for_each_fault(opening_ns, opened_ns, 2 * ms, [&](const sim::fault& fault) {
    virtual_bench bench({}, {&fault, 1});
    static_cast<void>(opens.measure(bench, fault, [&] { return open_virtual(bench); }));
  });
  opens.expect_between(2000 * ms, 3000 * ms);
}

TEST(CallTimes, Start) {
  longest_call starts("start()");
  measure_starts({}, ms / 2, starts);
  starts.expect_between(3 * 2000 * ms,
                        7000 * ms);  // three starts of start_ns, and the stops between
}

TEST(CallTimes, StartWithAllSettings) {
  lidar_options options;
  options.sample_rate = sample_rate::khz_8;
  options.frequency = scan_frequency::hz(11.5);
  options.direction = motor_direction::counter_clockwise;
  options.constant = constant_frequency::off;
  options.idle = low_power::off;
  options.protection = power_down_protection::on;
  longest_call starts("start()");
  measure_starts(options, 2 * ms, starts);
  starts.expect_between(7000 * ms, 10'000 * ms);
}

TEST(CallTimes, Stop) {
  longest_call stops("stop()");
  const std::int64_t stop_ns = 2500 * ms;
  for_each_fault(stop_ns - 20 * ms, stop_ns + 55 * ms, 15 * ms, [&](const sim::fault& fault) {
    virtual_bench bench({}, {&fault, 1});
    auto lidar = open_virtual(bench);
    ASSERT_TRUE(lidar && lidar->start());
    while (bench.now_ns < stop_ns) {
      if (const auto scan = lidar->try_scan(100ms); !scan && scan.error().is_fatal()) break;
    }
    static_cast<void>(stops.measure(bench, fault, [&] { return lidar->stop(); }));
  });
  stops.expect_between(1000 * ms, 1500 * ms);
}

}  // namespace
}  // namespace g4lidar
