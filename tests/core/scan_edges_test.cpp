// SPDX-License-Identifier: MIT
// Revolutions: odd turns, their frequency and times, and where their points are kept.
#include "g4lidar/core/scan_assembler.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <vector>

#include "turned_scans.hpp"

namespace g4lidar {
namespace {

using namespace test;

TEST(Scan, StoppedMotor_FillsTheStorageAndContinues) {
  scan_cutter cutter(500);
  zero(cutter);
  const made::packet still(0, 100 * 64, 100 * 64, 40);
  for (int i = 0; i < 30; ++i) cutter.feed(still.view());
  cutter.finish();
  EXPECT_EQ(sizes_of(cutter), (all_sizes{500, 500, 201}));
  EXPECT_EQ(marks_of(cutter),
            (all_marks{end_missing, start_missing | end_missing, start_missing | end_missing}));
  EXPECT_FLOAT_EQ(cutter.scans()[1].view.turned_deg, 0.0F);
  EXPECT_EQ(cutter.came_out(), cutter.put_in());
}

TEST(Scan, TurnThatEndsEarly_IsFlagged) {
  scan_cutter cutter(1000);
  zero(cutter);
  zero(cutter);  // the motor does not turn, at its index
  turn(cutter, 0, 350);
  zero(cutter, 349);
  turn(cutter, 350, 710);
  zero(cutter, 350);
  EXPECT_EQ(marks_of(cutter), (all_marks{turn_short, turn_short, whole}));
  // Without a first zero packet the size of the turn is not known.
  scan_cutter late(1000);
  turn(late, 350, 360);
  zero(late);
  EXPECT_EQ(marks_of(late), (all_marks{start_missing}));
}

TEST(Scan, TenDegreesEarly_IsTheLimitOfAWholeTurn) {
  scan_cutter cutter(1000);
  zero(cutter, 0);
  turn(cutter, 0, 350);
  zero(cutter, 350);
  turn(cutter, 350, 690);
  const made::packet early = made::zero(340 * 64 - 1);
  cutter.feed(early.view());
  EXPECT_EQ(marks_of(cutter), (all_marks{whole, turn_short}));
}

TEST(Scan, Finish_ResetsTheAssembler) {
  scan_cutter cutter(1000);
  cutter.finish();
  cutter.lost();
  cutter.finish();
  EXPECT_TRUE(cutter.scans().empty());
  turn(cutter, 0, 100);  // the loss was in the stream that has ended
  cutter.finish();
  EXPECT_EQ(marks_of(cutter), (all_marks{start_missing | end_missing}));
  cutter.finish();
  EXPECT_EQ(cutter.scans().size(), 1U);
  zero(cutter);
  turn(cutter, 0, 360);
  zero(cutter);
  EXPECT_EQ(cutter.scans().back().view.flags, whole);
  EXPECT_EQ(cutter.scans().back().points.size(), 721U);
}

TEST(Scan, LossAfterAScanWasReturned_FlagsTheNextScan) {
  std::array<point, 100> storage;
  scan_assembler assembler(storage);
  std::array<point, max_samples> out;
  const made::packet packet(0, 0, 640, 20);
  decoded now = decode(packet.view(), compact_correction{}, 0, out);
  EXPECT_FALSE(assembler.next(now));
  EXPECT_TRUE(assembler.finish());
  assembler.lost();
  now = decode(packet.view(), compact_correction{}, 0, out);
  EXPECT_FALSE(assembler.next(now));
  const auto last = assembler.finish();
  ASSERT_TRUE(last);
  EXPECT_EQ(last->flags, start_missing | end_missing | data_lost);
  EXPECT_EQ(last->points.size(), 20U);
}

TEST(Scan, ReportsTheFrequencyOfItsZeroPacket) {
  scan_cutter cutter(400);
  zero(cutter, 0, 71);
  turn(cutter, 0, 360);  // more than the storage holds
  zero(cutter, 0, 0);
  turn(cutter, 0, 100);
  zero(cutter, 0, 120);
  turn(cutter, 0, 100);
  cutter.finish();
  std::vector<int> reported;
  for (const kept_scan& kept : cutter.scans()) {
    reported.push_back(kept.view.reported_frequency_chz);
  }
  EXPECT_EQ(reported, (std::vector<int>{710, 0, 0, 1200}));
}

TEST(Scan, MeasuresTheFrequencyByTheTimesOfItsPoints) {
  // 8 Hz: a turn of 720 samples and a zero packet in 125 ms.
  constexpr std::int64_t step = 125'000'000 / 721;
  scan_cutter cutter(1000);
  std::int64_t now = 5'000'000'000;
  for (int turns = 0; turns < 3; ++turns) {
    const made::packet start = made::zero(0);
    cutter.feed(start.view(), now, step);
    now += step;
    for (int deg = 0; deg < 360; deg += 10) {
      const made::packet packet(0, deg * 64, deg * 64 + 19 * 32, 20);
      cutter.feed(packet.view(), now, step);
      now += 20 * step;
    }
  }
  cutter.finish();
  ASSERT_EQ(cutter.scans().size(), 3U);
  EXPECT_EQ(cutter.scans()[0].view.duration_ns, 721 * step);
  EXPECT_NEAR(cutter.scans()[0].view.measured_frequency_hz(), 8.0F, 1e-4F);
  EXPECT_EQ(cutter.scans()[2].view.duration_ns, 0);  // no packet came after it
  EXPECT_EQ(cutter.scans()[2].view.measured_frequency_hz(), 0.0F);
}

TEST(Scan, MeasuresThePieceByItsTimes) {
  constexpr std::int64_t step = 100'000;
  scan_cutter cutter(360);  // half a turn
  for (int deg = 0; deg < 720; deg += 10) {
    const made::packet packet(0, deg % 360 * 64, deg % 360 * 64 + 19 * 32, 20);
    cutter.feed(packet.view(), 1'000'000 + deg * 2 * step, step);
  }
  ASSERT_GE(cutter.scans().size(), 3U);
  for (const kept_scan& kept : cutter.scans()) {
    EXPECT_FLOAT_EQ(kept.view.turned_deg, 180.0F);
    EXPECT_EQ(kept.view.duration_ns, 360 * step);
    EXPECT_NEAR(kept.view.measured_frequency_hz(), 1e9F / 72e6F, 1e-3F);
  }
}

TEST(Scan, MeasuresTheFrequencyBySamplesWithoutTimes) {
  scan_cutter cutter(1000);
  turn(cutter, 270, 360);  // partial at its start only: the existing part is complete
  zero(cutter);
  turn(cutter, 0, 360);
  zero(cutter);
  turn(cutter, 0, 100);
  cutter.lost();
  turn(cutter, 200, 360);
  zero(cutter);
  ASSERT_EQ(cutter.scans().size(), 3U);
  EXPECT_EQ(cutter.scans()[1].view.duration_ns, 0);
  EXPECT_NEAR(cutter.scans()[0].view.measured_frequency_hz(), 12.5F, 1e-4F);
  EXPECT_NEAR(cutter.scans()[1].view.measured_frequency_hz(), 9000.0F / 721.0F, 1e-4F);
  EXPECT_EQ(cutter.scans()[2].view.measured_frequency_hz(), 0.0F);
}

TEST(Scan, LateZeroPacket_PointsBeyondTheTurnStay) {
  scan_cutter cutter(2000);
  zero(cutter);
  turn(cutter, 0, 360);
  const made::packet beyond(0, 10, 60, 20);  // up to 360.9 degrees
  cutter.feed(beyond.view());
  const made::packet late = made::zero(62);
  cutter.feed(late.view());
  EXPECT_EQ(marks_of(cutter), (all_marks{whole}));
  EXPECT_EQ(sizes_of(cutter), (all_sizes{741}));
}

TEST(Scan, StepBackAcrossZero_IsNotATurn) {
  scan_cutter cutter(2000);
  zero(cutter);
  turn(cutter, 0, 360);
  const made::packet beyond(0, 10, 60, 20);
  cutter.feed(beyond.view());
  cutter.lost();
  turn(cutter, 350, 370);  // back to 350 degrees, and on without a zero packet
  zero(cutter, 10);
  // Cut where the angle passed for the last time, after the packet at 350 degrees.
  EXPECT_EQ(marks_of(cutter), (all_marks{end_by_angle | data_lost, start_by_angle | turn_short}));
  EXPECT_EQ(sizes_of(cutter), (all_sizes{721 + 20 + 20, 20}));
}

TEST(Scan, LossAfterTheCut_FlagsOnlyTheNextScan) {
  scan_cutter cutter(2000);
  zero(cutter);
  turn(cutter, 0, 360);
  const made::packet beyond(0, 10, 50, 20);
  cutter.feed(beyond.view());
  cutter.lost();
  turn(cutter, 370, 720);
  zero(cutter);
  EXPECT_EQ(marks_of(cutter), (all_marks{end_by_angle, start_by_angle | data_lost}));
  EXPECT_EQ(sizes_of(cutter), (all_sizes{721, 20 + 700}));
  EXPECT_EQ(cutter.scans()[1].view.revolution, 0U);
}

TEST(Scan, Times_ShowAGapOfWholeTurns) {
  constexpr std::int64_t step = 100'000'000 / 720;  // 10 Hz
  for (const int gap_turns : {1, 2, 50}) {
    scan_cutter cutter(2000);
    const auto timed = [&](int from_deg, int to_deg) {
      for (int deg = from_deg; deg < to_deg; deg += 10) {
        const int first = deg % 360 * 64;
        const made::packet packet(0, first, (first + 19 * 32) % 23040, 20);
        cutter.feed(packet.view(), 1'000'000'000 + deg * 2 * step, step);
      }
    };
    const auto timed_zero = [&](int deg) {
      const made::packet packet = made::zero(0);
      cutter.feed(packet.view(), 1'000'000'000 + deg * 2 * step - step / 2, 0);
    };
    timed_zero(0);
    timed(0, 360);
    timed_zero(360);
    timed(360, 500);
    cutter.lost();
    timed(500 + gap_turns * 360, 720 + gap_turns * 360);
    timed_zero(720 + gap_turns * 360);
    EXPECT_EQ(marks_of(cutter),
              (all_marks{whole, end_by_angle | data_lost, start_by_angle | data_lost}))
        << gap_turns;
    EXPECT_EQ(sizes_of(cutter), (all_sizes{721, 281, 440})) << gap_turns;
  }
}

TEST(Scan, PointsDecodedIntoItsStorage_AreNotCopied) {
  std::array<point, 1000> storage;
  scan_assembler assembler(storage);
  std::size_t given = 0;
  std::size_t in_place = 0;
  const auto feed = [&](const made::packet& packet, std::uint32_t revolution) {
    const std::span<point> room = assembler.room();
    ASSERT_GE(room.size(), max_samples);
    const point* const place = room.data();
    decoded now =
        decode(packet.view(), compact_correction{}, revolution, room.first<max_samples>());
    while (const auto found = assembler.next(now)) {
      given += found->size();
      for (const point& p : *found) EXPECT_EQ(p.revolution, found->revolution);
    }
    const std::span<point> after = assembler.room();
    if (after.data() == place + packet.view().sample_count()) ++in_place;
  };
  for (std::uint32_t revolution = 0; revolution < 3; ++revolution) {
    feed(made::zero(0), revolution);
    for (int deg = 0; deg < 360; deg += 10) {
      feed(made::packet(0, deg * 64, deg * 64 + 19 * 32, 20), revolution);
    }
  }
  const auto last = assembler.finish();
  ASSERT_TRUE(last);
  EXPECT_EQ(given + last->size(), 3U * 721U);
  EXPECT_EQ(in_place, 3U * 37U - 2U);  // all except the zero packets that end a scan
}

TEST(Scan, IsARangeOfPointsWithTimes) {
  constexpr std::int64_t step = 1'000'000'000 / 8000;
  scan_cutter cutter(1000);
  cutter.set_sample_rate(4000);
  for (int turns = 0; turns < 2; ++turns) {
    const made::packet start = made::zero(0);
    cutter.feed(start.view(), 7'000'000'000 + turns * 721 * step, step);
    for (int deg = 0; deg < 360; deg += 10) {
      const made::packet packet(0, deg * 64, deg * 64 + 19 * 32, 20);
      cutter.feed(packet.view(), 7'000'000'000 + (turns * 721 + 1 + deg * 2) * step, step);
    }
  }
  cutter.finish();
  const scan& found = cutter.scans().front().view;
  EXPECT_EQ(std::distance(found.begin(), found.end()), 721);
  EXPECT_EQ(found.size(), 721U);
  EXPECT_FALSE(found.empty());
  EXPECT_EQ(&found[720], &found.points.back());
  EXPECT_EQ(found.time_ns(), 7'000'000'000);
  EXPECT_EQ(found.end_ns(), 7'000'000'000 + 721 * step);
  EXPECT_EQ(cutter.scans().back().view.end_ns(), 7'000'000'000 + (721 + 720) * step);
  EXPECT_NEAR(found.measured_sample_rate_hz(), 8000.0F, 0.01F);
  EXPECT_EQ(found.sample_rate_hz, 4000U);
  EXPECT_EQ(scan().measured_sample_rate_hz(), 9000.0F);
  EXPECT_TRUE(scan().empty());
  EXPECT_EQ(scan().time_ns() + scan().end_ns(), 0);
}

TEST(Scan, WorksInConstantExpressions) {
  static_assert([] {
    std::array<point, 50> storage{};
    std::array<point, max_samples> out{};
    scan_assembler assembler(storage);
    const made::packet packet(0, 0, 640, 40);
    decoded now = decode(packet.view(), compact_correction{}, 0, out);
    if (assembler.next(now)) return false;
    now = decode(packet.view(), compact_correction{}, 0, out);
    const auto full = assembler.next(now);
    if (!full || full->points.size() != 50) return false;
    if (assembler.next(now)) return false;
    const auto last = assembler.finish();
    return last && last->points.size() == 30 && !assembler.finish();
  }());
}

}  // namespace
}  // namespace g4lidar
