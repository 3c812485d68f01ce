// SPDX-License-Identifier: MIT
// The fastest model on a pseudo-terminal, sent by another program: read at scan pace, without a heap call.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "realtime/child_process.hpp"
#include "realtime/device_on_pty.hpp"
#include "support/allocation_count.hpp"

namespace g4lidar {
namespace {

/// How often this thread has waited so far.
long waits() {
  ::rusage used{};
  ::getrusage(RUSAGE_THREAD, &used);
  return used.ru_nvcsw;
}

// 20,000 samples a second, 45 kB a second, 3 revolutions a second: 500 packets a second, and a system that keeps
// 4 KiB, half of which come 22 times a second.
TEST(FastestModel, IsReadAtScanPaceWithoutAHeapCall) {
  test::expect_three_of_four([] {
    const test::scratch_directory directory;
    const std::string path = directory.file("tg50");
    const test::child_process program({G4_DUMP, "sim", "--model", "tg50", "--link", path},
                                      directory.file("output"));
    EXPECT_TRUE(program.prints(" at " + path)) << program.output();
    lidar_options options = test::patient_options(path);
    options.model = model_named("tg50");
    options.frequency = scan_frequency{300};
    auto device = lidar::open(options);
    EXPECT_TRUE(device) << device.error().message();
    EXPECT_TRUE(device && device->start());
    if (!device) return true;
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(device->try_scan(test::patience)) << i;
    constexpr int scans = 10;
    std::size_t points = 0;
    std::size_t whole = 0;
    long waited = waits();
    const std::size_t heap_calls = test::allocations_in([&] {
      for (int i = 0; i < scans; ++i) {
        const auto scan = device->try_scan(test::patience);
        if (!scan) break;
        points += scan->points.size();
        whole += scan->is_whole() ? 1U : 0U;
      }
    });
    waited = waits() - waited;
    EXPECT_EQ(heap_calls, 0U);
    if (device->counts().samples_lost > 0 || whole < scans) return false;
    EXPECT_NEAR(static_cast<double>(points), scans * 20'000.0 / 3.0, scans * 200.0);
    // At the pace of packets it waits 167 times in a revolution.
    EXPECT_LE(waited, scans * 40);
    return true;
  });
}

}  // namespace
}  // namespace g4lidar
