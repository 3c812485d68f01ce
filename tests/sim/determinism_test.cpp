// SPDX-License-Identifier: MIT
// Runs with faults: the same bytes for a seed, whatever calls the host makes, and without a heap.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "g4lidar/sim/device.hpp"
#include "support/allocation_count.hpp"
#include "support/host_side.hpp"

namespace {

using namespace g4lidar;
using sim::fault;
using sim::fault_kind;
using sim::make_fault;
using test::byte_vector;
using test::ms;
using test::second;

// Every kind of fault in 20 s.
std::vector<fault> troubles() {
  std::vector<fault> all;
  for (int kind = 0; kind <= static_cast<int>(fault_kind::jolt); ++kind) {
    all.push_back(make_fault(static_cast<fault_kind>(kind), kind * second, 3 * second / 2));
    if (all.back().rate < 1.0) all.back().rate *= 2.0;
  }
  return all;
}

sim::device_options device_with_seed(std::uint64_t seed) {
  sim::device_options options;
  options.scanner.seed = seed;
  options.scanner.noise_mm = 4.0;
  options.scanner.sample_rate_ratio = 0.98;
  options.scanner.sample_rate_drift_ppm = 200.0;
  return options;
}

// Sends a command every 700 ms, the same each time, and reads at these intervals.
byte_vector bytes_of_run(sim::device& simulated, std::int64_t look_every_ns) {
  constexpr std::array<std::uint8_t, 10> codes{0x60, 0x90, 0x0B, 0x65, 0xD0,
                                               0x60, 0xD9, 0x92, 0x60, 0x07};
  byte_vector all;
  std::size_t sent = 0;
  std::int64_t send_ns = 10 * ms;
  std::int64_t look_ns = 0;
  for (constexpr std::int64_t end_ns = 22 * second; look_ns <= end_ns;) {
    while (send_ns <= look_ns) {
      simulated.write(std::array<std::uint8_t, 2>{0xA5, codes[sent++ % codes.size()]}, send_ns);
      send_ns += 700 * ms;
    }
    std::array<std::uint8_t, 4096> part{};
    for (std::size_t count = 0; (count = simulated.read(part, look_ns)) > 0;) {
      all.insert(all.end(), part.begin(), part.begin() + static_cast<std::ptrdiff_t>(count));
    }
    look_ns = look_ns < end_ns ? std::min(look_ns + look_every_ns, end_ns) : end_ns + 1;
  }
  return all;
}

byte_vector bytes_of_run(std::uint64_t seed, std::int64_t look_every_ns) {
  sim::device simulated(sim::built_in_world(), device_with_seed(seed), troubles());
  return bytes_of_run(simulated, look_every_ns);
}

std::uint64_t digest(bytes data) {
  std::uint64_t state = 0xCBF29CE484222325U;  // FNV-1a
  for (const std::uint8_t byte : data) state = (state ^ byte) * 0x100000001B3U;
  return state;
}

TEST(SimDevice, SameSeed_SameBytesOnEveryProcessor) {
  EXPECT_EQ(digest(bytes_of_run(1, 100 * ms)), 0xDD2F2106F02B477BU)
      << std::hex << digest(bytes_of_run(1, 100 * ms));
  EXPECT_EQ(digest(bytes_of_run(2, 100 * ms)), 0x5138A60614B86159U)
      << std::hex << digest(bytes_of_run(2, 100 * ms));
}

// Reads cost nothing and change nothing, except for bytes that were waiting when the device was
// unplugged.
TEST(SimDevice, DoesNotDependOnTheNumberOfCalls) {
  std::vector<fault> faults = troubles();
  std::erase_if(faults, [](const fault& f) { return f.kind == fault_kind::unplug; });
  const auto bytes_when_looked_at = [&faults](std::int64_t every_ns) {
    sim::device simulated(sim::built_in_world(), device_with_seed(3), faults);
    return bytes_of_run(simulated, every_ns);
  };
  const byte_vector seldom = bytes_when_looked_at(140 * ms);
  EXPECT_GT(seldom.size(), 100'000U);
  // The read times are chosen so that all bytes have been read by the end.
  EXPECT_EQ(bytes_when_looked_at(ms), seldom);
  EXPECT_EQ(bytes_when_looked_at(7 * ms), seldom);
}

// The same of a lidar that drives, with people around.
TEST(SimDevice, DrivingDoesNotDependOnTheNumberOfCalls) {
  const auto read = sim::parse_world(
      "wall -4 -3 6 -3\nwall 6 -3 6 3\nwall 6 3 -4 3\nwall -4 3 -4 -3\n"
      "disc 0.25 -3 2 5 2.5 1.3\nlidar 0 0 0\ndrive arc 1 360\n");
  const auto bytes_when_looked_at = [&](std::int64_t every_ns) {
    sim::device simulated(std::get<sim::world>(read), device_with_seed(3));
    return bytes_of_run(simulated, every_ns);
  };
  const byte_vector seldom = bytes_when_looked_at(140 * ms);
  EXPECT_GT(seldom.size(), 100'000U);
  EXPECT_EQ(bytes_when_looked_at(ms), seldom);
  EXPECT_EQ(bytes_when_looked_at(7 * ms), seldom);
}

TEST(SimDevice, SlowReader_LosesBytesAndTheyAreCounted) {
  test::host_side host;
  host.send(command::start);
  (void)host.device.available(10 * second);
  EXPECT_EQ(host.device.available(10 * second), 65'536U);
  EXPECT_EQ(host.device.bytes_delivered() - host.device.bytes_overflowed(), 65'536U);
  EXPECT_GT(host.device.bytes_overflowed(), 130'000U);
}

TEST(SimDevice, NextNs_NeverSkipsABatch) {
  test::host_side by_next({}, {make_fault(fault_kind::batch)});
  test::host_side by_step({}, {make_fault(fault_kind::batch)});
  by_next.send(command::start);
  by_step.send(command::start);
  for (int i = 0; i < 400; ++i) {
    // listen() uses next_ns(); each batch must be available at that time.
    const byte_vector heard = by_next.listen(ms);
    byte_vector stepped;
    for (int step = 0; step < 100; ++step) {
      by_step.now_ns += 10'000;
      std::array<std::uint8_t, 1024> part{};
      const std::size_t count = by_step.device.read(part, by_step.now_ns);
      stepped.insert(stepped.end(), part.begin(),
                     part.begin() + static_cast<std::ptrdiff_t>(count));
    }
    ASSERT_EQ(heard, stepped);
  }
}

TEST(SimDevice, IdleDevice_HasNoNextEvent) {
  test::host_side host;
  EXPECT_EQ(host.device.next_ns(0), sim::forever_ns);
  EXPECT_TRUE(host.device.is_idle_and_silent(0));
  host.send(command::device_info);
  EXPECT_FALSE(host.device.is_idle_and_silent(0));
  EXPECT_LT(host.device.next_ns(0), 2 * ms);
}

TEST(SimDevice, AllocatesOnConstructionOnly) {
  sim::device simulated(sim::built_in_world(), device_with_seed(4), troubles());
  std::array<std::uint8_t, 4096> part{};
  std::array<sim::sent_sample, 256> truth{};
  std::size_t heard = 0;
  EXPECT_EQ(test::allocations_in([&] {
              for (std::int64_t now = 0; now < 22 * second; now += 10 * ms) {
                simulated.write(std::array<std::uint8_t, 2>{0xA5, 0x60}, now);
                simulated.write(std::array<std::uint8_t, 2>{0xA5, 0x90}, now);
                heard += simulated.read(part, now);
                (void)simulated.take_truth(truth);
              }
              simulated.clear_log();
            }),
            0U);
  EXPECT_GT(heard, 50'000U);
}

}  // namespace
