// SPDX-License-Identifier: MIT
// When a read is worth its system calls: the rules alone, and the savings of a driver.
#include "driver/read_schedule.hpp"

#include <utility>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "pace_bench.hpp"
#include "support/family_reference.hpp"
#include "support/packet_maker.hpp"

namespace g4lidar {
namespace {

using namespace test;
constexpr std::int64_t byte_ns = 10'000'000'000 / 230'400;
constexpr double period_ns = 1e9 / 9000;
constexpr std::int64_t packet_ns = 40 * second / 9000;

/// A pace that has received a zero packet and two packets of 40 samples and 10 degrees behind it,
/// the last one just now, alone.
struct PaceFarFromTheEnd : testing::Test {
  PaceFarFromTheEnd() {
    pace.reset(230'400, 4095);
    take(made::packet(1, 0, 0, 1));
    take(made::packet(0, 10 * 64, 20 * 64, 40));
    take(made::packet(0, 20 * 64, 30 * 64, 40));
  }
  void take(const made::packet& next, std::size_t behind = 0) {
    now_ns += 10 * ms;
    pace.received(next.data().size() + behind, now_ns);
    // The last sample was measured when the packet began to be sent.
    const auto size = static_cast<std::int64_t>(next.data().size() + behind);
    pace.packet(next.view(), behind, now_ns - size * byte_ns, period_ns);
  }

  read_schedule pace;
  std::int64_t now_ns = second;
};

TEST_F(PaceFarFromTheEnd, NextPacket_IsExpectedWhenItsSamplesAreMeasured) {
  EXPECT_NEAR(static_cast<double>(pace.next_ns(0, 1, demand::points)),
              static_cast<double>(now_ns + packet_ns), 50e3);
}

TEST_F(PaceFarFromTheEnd, ExpectedPacket_IsReadEarlierEachTime) {
  const std::int64_t due_ns = pace.next_ns(0, 1, demand::points);
  now_ns = due_ns - 10 * ms + 80 * us;  // where take() finds it: late by a wake-up
  take(made::packet(0, 30 * 64, 40 * 64, 40));
  const std::int64_t apart_ns = pace.next_ns(0, 1, demand::points) - due_ns;
  EXPECT_LT(apart_ns, packet_ns - 20 * us);
  EXPECT_GT(apart_ns, packet_ns - 50 * us);
}

TEST_F(PaceFarFromTheEnd, IncompletePacket_RestIsWaitedFor) {
  now_ns += 4 * ms;
  pace.received(80, now_ns);
  EXPECT_EQ(pace.next_ns(80, 10, demand::points), now_ns + 10 * byte_ns);
}

TEST_F(PaceFarFromTheEnd, BytesBehindAPacket_ShowItsAge) {
  pace.received(1, now_ns);  // not as expected
  take(made::packet(0, 30 * 64, 40 * 64, 40), 20);
  const std::int64_t expected_ns = now_ns - 20 * byte_ns + packet_ns;
  EXPECT_NEAR(static_cast<double>(pace.next_ns(20, 70, demand::points)),
              static_cast<double>(expected_ns), 50e3);
}

TEST_F(PaceFarFromTheEnd, NearTheEnd_NoScanIsDelayed) {
  take(made::packet(0, 330 * 64, 340 * 64, 40));
  EXPECT_LE(pace.next_ns(0, 1, demand::points), now_ns + 12 * byte_ns);
  EXPECT_LE(pace.next_ns(11, 1, demand::points), now_ns);
}

TEST_F(PaceFarFromTheEnd, NoZeroPacket_AnyPacketMayBeTheEnd) {
  pace.reset(230'400, 4095);
  take(made::packet(0, 10 * 64, 20 * 64, 40));
  take(made::packet(0, 20 * 64, 30 * 64, 40));
  EXPECT_LE(pace.next_ns(0, 1, demand::points), now_ns + 12 * byte_ns);
}

TEST_F(PaceFarFromTheEnd, TruncatedPacket_DoesNotPredictTheNext) {
  take(made::packet(0, 350 * 64, 359 * 64, 36));
  take(made::packet(1, 0, 0, 1));
  EXPECT_NEAR(static_cast<double>(pace.next_ns(0, 1, demand::points)),
              static_cast<double>(now_ns + packet_ns), 50e3);
}

TEST_F(PaceFarFromTheEnd, Flood_IsReadWithoutWaiting) {
  for (int i = 0; i < 3; ++i) pace.received(4096, now_ns += 100 * us);
  EXPECT_EQ(pace.next_ns(11, 79, demand::points), 0);
  pace.received(1, now_ns += second);
  EXPECT_GT(pace.next_ns(12, 78, demand::points), now_ns);
}

TEST_F(PaceFarFromTheEnd, StalledTransport_MayCatchUp) {
  pace.received(10, now_ns += 190 * ms);
  pace.received(3'000, now_ns += 100 * us);
  EXPECT_GT(pace.next_ns(11, 79, demand::points), now_ns);
}

TEST_F(PaceFarFromTheEnd, UselessWaits_BecomeRare) {
  int rests = 0;
  for (int i = 0; i < 1'000; ++i) {
    pace.received(10, now_ns += 16 * ms);
    if (pace.next_ns(10, 80, demand::points) <= now_ns) continue;
    ++rests;
    pace.nothing_complete();
  }
  EXPECT_GT(rests, 10);
  EXPECT_LT(rests, 30);
  pace.reset(230'400, 4095);
  pace.received(10, now_ns += 16 * ms);
  EXPECT_GT(pace.next_ns(10, 80, demand::points), now_ns);
}

TEST_F(PaceFarFromTheEnd, NoBaudRate_NoWait) {
  pace.reset(0, 4095);
  pace.received(10, now_ns);
  EXPECT_EQ(pace.next_ns(10, 80, demand::points), 0);
}

// A T-mini Plus SH sends 4 bytes a sample: 142 bytes with 33 samples, 102 with 23, 14 with one.
TEST(Forecast, PacketsHaveTheSizeOfTheirLayout) {
  const reference::wire_format& format = reference::wire_formats.back();
  const model& which = *model_named(format.model);
  revolution_forecast forecast;
  const auto take = [&](unsigned ct, unsigned first, unsigned last, std::size_t samples,
                        std::int64_t measured_ns) {
    const auto made = reference::packet_of(format, ct, first, last,
                                           std::vector(samples, reference::wire_sample{7, 500}));
    forecast.packet(*packet_view::from(made, which.samples), measured_ns, measured_ns, 250e3,
                    byte_ns);
  };
  take(1, 0, 0, 1, second);
  take(0, 0, 8 * 64, 33, second + 8 * ms);
  take(0, 8 * 64, 16 * 64, 33, second + 16 * ms);
  // 344 degrees are left: 1376 samples, 41 packets of 33 and one of 23, and then the zero packet.
  EXPECT_EQ(forecast.end_ns(), second + 16 * ms + 41 * 33 * 250 * us + (142 + 102 + 14) * byte_ns);
}

// The system may keep 4095 bytes, of which half are 178 ms of an X2 and 89 ms of a G4.
TEST(Pace, WhereTheRateIsNotKnown_ItIsThatOfTheModel) {
  for (const auto& [word, at_most_ns] : {std::pair{"x2", 178 * ms}, std::pair{"g4", 89 * ms}}) {
    read_schedule pace(*model_named(word));
    pace.reset(0, 4095);
    std::int64_t now_ns = second;
    for (const auto& next : {made::packet(1, 0, 0, 1), made::packet(0, 0, 4 * 64, 40),
                             made::packet(0, 4 * 64, 8 * 64, 40)}) {
      now_ns += 10 * ms;
      pace.received(next.data().size(), now_ns);
      pace.packet(next.view(), 0, now_ns, period_ns);
    }
    const std::int64_t rest_ns = pace.next_ns(0, 1, demand::scans) - now_ns;
    EXPECT_LE(rest_ns, at_most_ns) << word;
    EXPECT_GT(rest_ns, at_most_ns - 2 * ms) << word;
  }
}

TEST(Pace, SavesReadsAndDelaysNoScan) {
  test::virtual_bench bench;
  auto lidar = test::open_virtual(bench);
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->start());
  static_cast<void>(lidar->points());  // each packet is wanted
  while (bench.now_ns < 4 * second) static_cast<void>(lidar->try_scan(500ms));
  const std::uint64_t before = bench.reads + bench.pauses;
  std::uint64_t scans = 0;
  while (bench.now_ns < 14 * second) {
    const auto scan = lidar->try_scan(500ms);
    ASSERT_TRUE(scan);
    ++scans;
    // The transmission of the last packet of a revolution takes 4 ms at most, and its end half a
    // millisecond.
    EXPECT_LT(bench.now_ns - scan->points.back().time_ns, 6 * ms);
  }
  EXPECT_GT(scans, 65U);
  EXPECT_LT(bench.reads + bench.pauses - before, 11'000U);
}

TEST(Pace, Wake_EndsAWait) {
  test::virtual_bench bench;
  auto lidar = test::open_virtual(bench);
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->start());
  for (int i = 0; i < 100; ++i) {
    static_cast<void>(lidar->try_scan(9ms));
    const std::int64_t begin_ns = bench.now_ns;
    lidar->wake();
    const auto woken = lidar->try_scan(2000ms);
    ASSERT_FALSE(woken);
    ASSERT_EQ(woken.error().code(), problem::cancelled);
    ASSERT_LT(bench.now_ns - begin_ns, ms);
  }
}

}  // namespace
}  // namespace g4lidar
