// SPDX-License-Identifier: MIT
// Devices that send a CRC before zero packets, and time packets between others.
#include <gtest/gtest.h>

#include <array>
#include <span>

#include "g4lidar/lidar.hpp"
#include "support/virtual_transport.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using test::open_virtual;
using test::virtual_bench;

constexpr std::int64_t ms = 1'000'000;

sim::device_options newer_device() {
  sim::device_options options;
  options.ct_crc = true;
  options.time_packet_ns = 100 * ms;
  return options;
}

void expect_consistent(const lidar_counts& counts) {
  EXPECT_EQ(counts.bytes, counts.stream.parsed_bytes + counts.stream.skipped_bytes() + counts.held);
}

TEST(CrcByte, HealthyDevice_HasWholeScans) {
  virtual_bench bench(newer_device());
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar && lidar->start());
  for (int i = 0; i < 50; ++i) {
    const auto scan = lidar->try_scan(2s);
    ASSERT_TRUE(scan) << scan.error().message();
    EXPECT_TRUE(scan->is_whole()) << i;
  }
  const lidar_counts counts = lidar->counts();
  EXPECT_GE(counts.stream.crc_matches, 46U);
  EXPECT_EQ(counts.stream.crc_mismatches, 0U);
  EXPECT_GE(counts.stream.time_packets, 60U);
  EXPECT_LE(counts.stream.skipped_bytes(), 60U) << "time packets are no noise";
  expect_consistent(counts);
}

TEST(CrcByte, LostPacket_FlagsItsScan) {
  sim::fault omitted = sim::make_fault(sim::fault_kind::omit, 6'000 * ms, 6 * ms);
  omitted.rate = 1.0;
  virtual_bench bench(newer_device(), std::span(&omitted, 1));
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar && lidar->start());
  int flagged = 0;
  while (bench.now_ns < 9'000 * ms) {
    const auto scan = lidar->try_scan(2s);
    ASSERT_TRUE(scan) << scan.error().message();
    flagged += scan->has(scan_flags::crc_mismatch);
    EXPECT_EQ(scan->is_whole(), !scan->has(scan_flags::crc_mismatch));
  }
  EXPECT_EQ(flagged, 1);
  EXPECT_EQ(lidar->counts().stream.crc_mismatches, 1U);
  expect_consistent(lidar->counts());
}

TEST(CrcByte, OtherDevice_IsNotFlagged) {
  sim::fault omitted = sim::make_fault(sim::fault_kind::omit, 6'000 * ms, 6 * ms);
  omitted.rate = 1.0;
  virtual_bench bench({}, std::span(&omitted, 1));
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar && lidar->start());
  while (bench.now_ns < 9'000 * ms) {
    const auto scan = lidar->try_scan(2s);
    ASSERT_TRUE(scan) << scan.error().message();
    EXPECT_FALSE(scan->has(scan_flags::crc_mismatch));
  }
  EXPECT_EQ(lidar->counts().stream.crc_matches + lidar->counts().stream.crc_mismatches, 0U);
}

// Revolutions that are cut by a stop, or by an unplug, are not compared.
TEST(CrcByte, CutRevolutions_AreNotFlagged) {
  virtual_bench bench(newer_device());
  lidar_options options;
  options.reconnect = true;
  auto lidar = open_virtual(bench, options);
  ASSERT_TRUE(lidar);
  for (int i = 0; i < 6; ++i) {
    ASSERT_TRUE(lidar->start());
    for (int scans = 0; scans < 6;) {
      const auto scan = lidar->try_scan(10s);
      ASSERT_TRUE(scan || !scan.error().is_fatal()) << scan.error().message();
      if (!scan) continue;  // it is being reconnected
      EXPECT_FALSE(scan->has(scan_flags::crc_mismatch));
      ++scans;
    }
    static_cast<void>(lidar->try_scan(std::chrono::milliseconds(10 + 17 * i)));
    if (i % 2 == 0) {
      ASSERT_TRUE(lidar->stop());
    } else {
      bench.device.unplug(bench.now_ns);
      bench.now_ns += 500 * ms;
      bench.device.replug(bench.now_ns);
    }
  }
  EXPECT_EQ(lidar->counts().stream.crc_mismatches, 0U);
  EXPECT_GT(lidar->counts().stream.crc_matches, 10U);
  expect_consistent(lidar->counts());
}

}  // namespace
}  // namespace g4lidar
