// SPDX-License-Identifier: MIT
// A lidar that was unplugged and returns: how soon it is started again, and its first scan, after an outage of any
// length.
#include <gtest/gtest.h>

#include <cstdint>

#include "g4lidar/lidar.hpp"
#include "support/test_scale.hpp"
#include "support/virtual_transport.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t second = 1'000 * ms;

/// Its motor is at speed as soon as it is started. It begins at an angle that depends on the seed.
sim::device_options quick_device(std::uint64_t seed) {
  sim::device_options options;
  options.scanner.seed = seed;
  options.boot_ns = 0;
  options.standstill_ns = 0;
  options.acceleration_mhz_per_s = 100'000'000;
  return options;
}

struct return_times {
  std::int64_t started_ns = 0;  ///< From the replug until it scans.
  std::int64_t scan_ns = 0;     ///< And from then on to the first scan.
};

return_times return_after(std::int64_t outage_ns, bool watches, std::uint64_t seed) {
  test::virtual_bench bench(quick_device(seed));
  bench.watches = watches;
  lidar_options options;
  options.reconnect = true;
  auto device = test::open_virtual(bench, options);
  EXPECT_TRUE(device);
  EXPECT_TRUE(device->start());
  while (bench.now_ns < 3 * second) static_cast<void>(device->try_scan(20ms));
  bench.device.unplug(bench.now_ns);
  const std::int64_t back_ns = bench.now_ns + outage_ns;
  while (bench.now_ns < back_ns) static_cast<void>(device->try_scan(1ms));
  bench.device.replug(bench.now_ns);
  const std::int64_t replugged_ns = bench.now_ns;
  std::int64_t started_ns = 0;
  while (!device->try_scan(1ms) && bench.now_ns < replugged_ns + 10 * second) {
    if (started_ns == 0 && bench.device.is_scanning()) started_ns = bench.now_ns;
  }
  EXPECT_EQ(device->counts().reconnects, 1U);
  return {started_ns - replugged_ns, bench.now_ns - started_ns};
}

class Return : public testing::TestWithParam<std::int64_t> {};

// The revolution in which it begins is not whole, the next one is: two revolutions of 143 ms at most.
TEST_P(Return, ItIsStartedWithin100msAndScansWithin300msMore) {
  for (const int seed : test::seeds(20)) {
    const return_times times =
        return_after(GetParam() * ms, true, static_cast<std::uint64_t>(seed));
    EXPECT_GT(times.started_ns, 0) << seed;
    EXPECT_LE(times.started_ns, 100 * ms) << seed;
    EXPECT_LE(times.scan_ns, 300 * ms) << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(AfterMilliseconds, Return, testing::Values(20, 300, 3'000, 60'000));

TEST(ReturnUnseen, IsFoundByTrying) {
  EXPECT_LE(return_after(3 * second, false, 1).started_ns, 1'100 * ms);
}

}  // namespace
}  // namespace g4lidar
