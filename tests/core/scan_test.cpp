// SPDX-License-Identifier: MIT
// Revolutions: where they are cut, what they are marked with, and that no point is lost to them.
#include "g4lidar/scan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <vector>

#include "support/packet_maker.hpp"
#include "support/scan_cutter.hpp"

namespace g4lidar {

// For GoogleTest's messages.
inline void PrintTo(scan_marks marks, std::ostream* out) {
  *out << "marks " << static_cast<unsigned>(marks);
}

namespace {

using test::kept_scan;
using test::scan_cutter;

constexpr scan_marks whole = scan_marks::none;
constexpr scan_marks start_missing = scan_marks::start_missing;
constexpr scan_marks end_missing = scan_marks::end_missing;
constexpr scan_marks data_lost = scan_marks::data_lost;
constexpr scan_marks turn_short = scan_marks::turn_short;

/// Feeds samples from `from_deg` on, 2 to a degree and 20 to a packet, up to but not including
/// `to_deg`, both multiples of 10; they may be beyond 360.
void turn(scan_cutter& cutter, int from_deg, int to_deg) {
  for (int deg = from_deg; deg < to_deg; deg += 10) {
    const int first = deg % 360 * 64;
    const made::packet packet(0x86, first, (first + 19 * 32) % 23040, 20);
    cutter.feed(packet.view());
  }
}
void zero(scan_cutter& cutter, int deg = 0, unsigned frequency_dhz = 0) {
  const made::packet packet = made::zero(deg * 64, 4000, frequency_dhz);
  cutter.feed(packet.view());
}
void suspect(scan_cutter& cutter, int deg, unsigned ct = 0, std::size_t samples = 20) {
  const made::packet packet(ct, deg * 64, deg * 64 - 30, samples);
  cutter.feed(packet.view());
}

/// The marks of all scans so far.
std::vector<scan_marks> marks_of(const scan_cutter& cutter) {
  std::vector<scan_marks> marks;
  for (const kept_scan& kept : cutter.scans()) marks.push_back(kept.view.marks);
  return marks;
}
std::vector<std::size_t> sizes_of(const scan_cutter& cutter) {
  std::vector<std::size_t> sizes;
  for (const kept_scan& kept : cutter.scans()) sizes.push_back(kept.points.size());
  return sizes;
}

using all_marks = std::vector<scan_marks>;
using all_sizes = std::vector<std::size_t>;

TEST(Scan, FirstIsPartialAndTheNextAreWhole) {
  scan_cutter cutter(1000);
  turn(cutter, 260, 360);
  for (int i = 0; i < 3; ++i) {
    zero(cutter);
    turn(cutter, 0, 360);
  }
  EXPECT_EQ(marks_of(cutter), (all_marks{start_missing, whole, whole}));
  EXPECT_EQ(sizes_of(cutter), (all_sizes{200, 721, 721}));
  cutter.finish();
  EXPECT_EQ(cutter.scans().back().view.marks, end_missing);
  EXPECT_EQ(cutter.came_out(), cutter.put_in());
  EXPECT_TRUE(cutter.scans()[1].view.is_whole());
  EXPECT_FALSE(cutter.scans()[1].view.is_partial());
  EXPECT_TRUE(cutter.scans()[0].view.is_partial());
}

TEST(Scan, BeginsWithThePointOfItsZeroPacket) {
  scan_cutter cutter(1000);
  for (int i = 0; i < 3; ++i) {
    zero(cutter, 348);
    turn(cutter, 350, 700);
  }
  cutter.finish();
  ASSERT_EQ(cutter.scans().size(), 3U);
  std::uint32_t number = 0;
  for (const kept_scan& kept : cutter.scans()) {
    EXPECT_TRUE(kept.points.front().is_revolution_start());
    EXPECT_EQ(std::count_if(kept.points.begin(), kept.points.end(),
                            [](const point& p) { return p.is_revolution_start(); }),
              1);
    EXPECT_EQ(kept.view.revolution, number++);
  }
  EXPECT_EQ(marks_of(cutter), (all_marks{whole, whole, end_missing}));
}

TEST(Scan, ALostZeroPacketGivesTwoMarkedPieces) {
  scan_cutter cutter(2000);
  zero(cutter);
  turn(cutter, 0, 720);  // the zero packet at 360 is not there
  zero(cutter);
  turn(cutter, 0, 360);
  zero(cutter);
  EXPECT_EQ(marks_of(cutter), (all_marks{end_missing, start_missing, whole}));
  // 0 to 361 degrees are the first one's, both ends included.
  EXPECT_EQ(sizes_of(cutter), (all_sizes{1 + 723, 1440 - 723, 721}));
  EXPECT_EQ(cutter.scans()[0].view.revolution, 0U);
  EXPECT_EQ(cutter.scans()[1].view.revolution, 0U);
  EXPECT_EQ(cutter.scans()[2].view.revolution, 1U);
  EXPECT_FLOAT_EQ(cutter.scans()[0].view.turned_deg, 361.5F);  // to the next one's first point
  EXPECT_FLOAT_EQ(cutter.scans()[1].view.turned_deg, 358.5F);
  cutter.finish();
  EXPECT_EQ(cutter.came_out(), cutter.put_in());
}

TEST(Scan, ManyLostZeroPacketsGiveManyPieces) {
  scan_cutter cutter(5000);
  turn(cutter, 100, 100 + 10 * 360);
  cutter.finish();
  EXPECT_EQ(cutter.scans().size(), 10U);
  for (const kept_scan& kept : cutter.scans()) {
    EXPECT_EQ(kept.view.marks, start_missing | end_missing);
    EXPECT_LE(kept.points.size(), 723U);
  }
  EXPECT_EQ(cutter.came_out(), cutter.put_in());
}

TEST(Scan, AZeroPacketHalfADegreeLateIsNotLost) {
  scan_cutter cutter(1000);
  const made::packet early = made::zero(22285);  // real ones: 348.2 degrees and then 348.7
  const made::packet late = made::zero(22317);
  cutter.feed(early.view());
  turn(cutter, 350, 700);
  const made::packet last(0, 22285, 22316, 20);
  cutter.feed(last.view());
  cutter.feed(late.view());
  EXPECT_EQ(marks_of(cutter), (all_marks{whole}));
  EXPECT_FLOAT_EQ(cutter.scans()[0].view.turned_deg, 360.5F);
}

TEST(Scan, AFullStorageCutsAndLosesNothing) {
  scan_cutter cutter(300);
  for (int i = 0; i < 2; ++i) {
    zero(cutter);
    turn(cutter, 0, 360);
  }
  cutter.finish();
  EXPECT_EQ(marks_of(cutter),
            (all_marks{end_missing, start_missing | end_missing, start_missing, end_missing,
                       start_missing | end_missing, start_missing | end_missing}));
  EXPECT_EQ(sizes_of(cutter), (all_sizes{300, 300, 121, 300, 300, 121}));
  EXPECT_EQ(cutter.came_out(), cutter.put_in());
}

TEST(Scan, AStorageOfExactlyOneRevolutionIsEnough) {
  scan_cutter cutter(721);
  for (int i = 0; i < 3; ++i) {
    zero(cutter);
    turn(cutter, 0, 360);
  }
  EXPECT_EQ(marks_of(cutter), (all_marks{whole, whole}));
}

TEST(Scan, AStorageOfOnePointStillLosesNothing) {
  scan_cutter cutter(1);
  zero(cutter);
  turn(cutter, 0, 20);
  zero(cutter);
  cutter.finish();
  EXPECT_EQ(cutter.scans().size(), 42U);
  EXPECT_EQ(cutter.came_out(), cutter.put_in());
}

TEST(Scan, ASuspectPacketMarksItsScan) {
  scan_cutter cutter(1000);
  zero(cutter);
  turn(cutter, 0, 100);
  suspect(cutter, 105);
  suspect(cutter, 106, 0x86, 3);
  turn(cutter, 110, 360);
  zero(cutter);
  turn(cutter, 0, 360);
  zero(cutter);
  EXPECT_EQ(marks_of(cutter), (all_marks{data_lost, whole}));
  EXPECT_EQ(cutter.scans()[0].view.suspect_packets, 2U);
  EXPECT_EQ(cutter.scans()[0].view.suspect_samples, 23U);
  EXPECT_EQ(cutter.scans()[1].view.suspect_packets, 0U);
  EXPECT_FLOAT_EQ(cutter.scans()[0].view.turned_deg, 360.0F);
}

TEST(Scan, ASuspectZeroPacketStartsARevolution) {
  scan_cutter cutter(1000);
  zero(cutter);
  turn(cutter, 0, 360);
  suspect(cutter, 10, 1 | 65U << 1, 4);
  turn(cutter, 10, 360);
  zero(cutter);
  EXPECT_EQ(marks_of(cutter), (all_marks{whole, data_lost}));
  EXPECT_EQ(cutter.scans()[1].view.revolution, 1U);
  EXPECT_EQ(cutter.scans()[1].view.suspect_samples, 4U);
  EXPECT_EQ(cutter.scans()[1].view.reported_frequency_dhz, 65);
  EXPECT_EQ(cutter.scans()[1].points.size(), 700U);
}

TEST(Scan, NothingButSuspectPacketsIsAScanWithoutPoints) {
  scan_cutter cutter(1000);
  suspect(cutter, 100);
  suspect(cutter, 1, 1);
  suspect(cutter, 200);
  cutter.finish();
  EXPECT_EQ(marks_of(cutter), (all_marks{start_missing | data_lost, data_lost | end_missing}));
  EXPECT_EQ(sizes_of(cutter), (all_sizes{0, 0}));
  EXPECT_EQ(cutter.scans()[0].view.suspect_packets, 1U);
  EXPECT_EQ(cutter.scans()[1].view.suspect_packets, 2U);
  EXPECT_EQ(cutter.scans()[1].view.revolution, 1U);
}

TEST(Scan, LossMarksTheScanInWhichItFalls) {
  scan_cutter cutter(1000);
  cutter.lost();  // before anything: no scan's loss
  zero(cutter);
  turn(cutter, 0, 360);
  zero(cutter);
  turn(cutter, 0, 200);
  cutter.lost();
  turn(cutter, 220, 360);
  zero(cutter);
  turn(cutter, 0, 360);
  cutter.lost();  // up to the zero packet it is the ending scan's
  zero(cutter);
  cutter.lost();  // and from it on the beginning one's
  turn(cutter, 10, 360);
  zero(cutter);
  EXPECT_EQ(marks_of(cutter), (all_marks{whole, data_lost, data_lost, data_lost}));
}

TEST(Scan, SkippedBytesAreALossIfAPacketMayHaveBeenAmongThem) {
  const auto marks_after = [](const std::vector<skipped>& gone) {
    scan_cutter cutter(1000);
    zero(cutter);
    turn(cutter, 0, 180);
    for (const skipped& each : gone) cutter.add(each);
    turn(cutter, 180, 360);
    zero(cutter);
    return cutter.scans().at(0).view.marks;
  };
  EXPECT_EQ(marks_after({{1, skip_reason::bad_header}}), data_lost);
  EXPECT_EQ(marks_after({{1, skip_reason::bad_checksum}}), data_lost);
  EXPECT_EQ(marks_after({{1, skip_reason::truncated}}), data_lost);
  // A packet whose first byte is damaged, in one piece and in many; and less than a packet.
  EXPECT_EQ(marks_after({{50, skip_reason::noise}}), data_lost);
  EXPECT_EQ(marks_after(std::vector<skipped>(11, {1, skip_reason::noise})), data_lost);
  EXPECT_EQ(marks_after({{10, skip_reason::noise}}), whole);
}

TEST(Scan, StrayBytesDoNotAddUpBeyondAPacket) {
  scan_cutter cutter(1000);
  zero(cutter);
  for (int deg = 0; deg < 360; deg += 10) {
    cutter.add({1, skip_reason::noise});
    turn(cutter, deg, deg + 10);
  }
  zero(cutter);
  EXPECT_EQ(marks_of(cutter), (all_marks{whole}));
}

TEST(Scan, LossOverAZeroPacketIsCutByTheAngle) {
  scan_cutter cutter(2000);
  zero(cutter);
  turn(cutter, 0, 300);
  cutter.lost();
  turn(cutter, 400, 720);
  zero(cutter);
  EXPECT_EQ(marks_of(cutter), (all_marks{end_missing | data_lost, start_missing}));
  EXPECT_EQ(sizes_of(cutter), (all_sizes{601, 640}));
  EXPECT_FLOAT_EQ(cutter.scans()[0].view.turned_deg, 400.0F);
}

TEST(Scan, GapsOfAnySizeUnderSevenEighthsOfATurnAreFollowed) {
  for (const int gap : {20, 90, 180, 270, 310}) {
    scan_cutter cutter(1000);
    zero(cutter);
    turn(cutter, 0, 20);
    turn(cutter, 20 + gap, 360);
    zero(cutter);
    ASSERT_EQ(cutter.scans().size(), 1U);
    EXPECT_EQ(cutter.scans()[0].view.marks, whole) << gap;
    EXPECT_FLOAT_EQ(cutter.scans()[0].view.turned_deg, 360.0F) << gap;
  }
}

TEST(Scan, SmallStepsBackAreNotATurn) {
  scan_cutter cutter(2000);
  zero(cutter);
  turn(cutter, 0, 180);
  turn(cutter, 150, 200);  // the motor went back by 30 degrees
  turn(cutter, 160, 360);
  zero(cutter);
  EXPECT_EQ(marks_of(cutter), (all_marks{whole}));
  EXPECT_FLOAT_EQ(cutter.scans()[0].view.turned_deg, 360.0F);
}

TEST(Scan, APacketThatSpansNearlyTheWholeCircleIsFollowed) {
  scan_cutter cutter(2000);
  zero(cutter);
  const made::packet wide(0, 0, 350 * 64, 80);  // LSA >= FSA is taken as it stands
  cutter.feed(wide.view());
  turn(cutter, 360, 370);
  zero(cutter, 10);
  ASSERT_EQ(cutter.scans().size(), 2U);
  EXPECT_EQ(marks_of(cutter), (all_marks{end_missing, start_missing}));
  EXPECT_EQ(sizes_of(cutter), (all_sizes{81 + 3, 17}));
}

TEST(Scan, ACutMayFallInsideAWidePacket) {
  scan_cutter cutter(2000);
  zero(cutter, 300);
  turn(cutter, 300, 600);
  const made::packet wide(0, 240 * 64, 319 * 64, 80);  // a sample each degree; the turn ends at 301
  cutter.feed(wide.view());
  cutter.finish();
  EXPECT_EQ(sizes_of(cutter), (all_sizes{1 + 600 + 62, 18}));
  EXPECT_EQ(cutter.came_out(), cutter.put_in());
}

TEST(Scan, AMotorStandingStillFillsTheStorageAndGoesOn) {
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

TEST(Scan, ATurnThatEndsEarlyIsMarked) {
  scan_cutter cutter(1000);
  zero(cutter);
  zero(cutter);  // the motor stands still on its mark
  turn(cutter, 0, 350);
  zero(cutter, 349);
  turn(cutter, 350, 710);
  zero(cutter, 350);
  EXPECT_EQ(marks_of(cutter), (all_marks{turn_short, turn_short, whole}));
  // Without a first zero packet nobody knows how much of a turn there was.
  scan_cutter late(1000);
  turn(late, 350, 360);
  zero(late);
  EXPECT_EQ(marks_of(late), (all_marks{start_missing}));
}

TEST(Scan, TenDegreesEarlyIsTheLimitOfAWholeTurn) {
  scan_cutter cutter(1000);
  zero(cutter, 0);
  turn(cutter, 0, 350);
  zero(cutter, 350);
  turn(cutter, 350, 690);
  const made::packet early = made::zero(340 * 64 - 1);
  cutter.feed(early.view());
  EXPECT_EQ(marks_of(cutter), (all_marks{whole, turn_short}));
}

TEST(Scan, FinishLeavesTheAssemblerAsNew) {
  scan_cutter cutter(1000);
  cutter.finish();
  cutter.lost();
  cutter.finish();
  EXPECT_TRUE(cutter.scans().empty());
  turn(cutter, 0, 100);  // the loss was of the stream that has ended
  cutter.finish();
  EXPECT_EQ(marks_of(cutter), (all_marks{start_missing | end_missing}));
  cutter.finish();
  EXPECT_EQ(cutter.scans().size(), 1U);
  zero(cutter);
  turn(cutter, 0, 360);
  zero(cutter);
  EXPECT_EQ(cutter.scans().back().view.marks, whole);
  EXPECT_EQ(cutter.scans().back().points.size(), 721U);
}

TEST(Scan, LossRightAfterAScanWasGivenIsTheNextOnes) {
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
  EXPECT_EQ(last->marks, start_missing | end_missing | data_lost);
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
    reported.push_back(kept.view.reported_frequency_dhz);
  }
  EXPECT_EQ(reported, (std::vector<int>{71, 0, 0, 120}));
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
  EXPECT_NEAR(cutter.scans()[0].view.measured_frequency_hz(9000), 8.0F, 1e-4F);
  EXPECT_EQ(cutter.scans()[2].view.duration_ns, 0);  // nothing came after it
  EXPECT_EQ(cutter.scans()[2].view.measured_frequency_hz(9000), 0.0F);
}

TEST(Scan, MeasuresAPieceByItsTimesToo) {
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
    EXPECT_NEAR(kept.view.measured_frequency_hz(0), 1e9F / 72e6F, 1e-3F);
  }
}

TEST(Scan, MeasuresTheFrequencyByItsSamplesWhereNoTimesAreKnown) {
  scan_cutter cutter(1000);
  turn(cutter, 270, 360);  // partial at its start only: what is there is all there
  zero(cutter);
  turn(cutter, 0, 360);
  zero(cutter);
  turn(cutter, 0, 100);
  cutter.lost();
  turn(cutter, 200, 360);
  zero(cutter);
  ASSERT_EQ(cutter.scans().size(), 3U);
  EXPECT_EQ(cutter.scans()[1].view.duration_ns, 0);
  EXPECT_NEAR(cutter.scans()[0].view.measured_frequency_hz(9000), 12.5F, 1e-4F);
  EXPECT_NEAR(cutter.scans()[1].view.measured_frequency_hz(9000), 9000.0F / 721.0F, 1e-4F);
  EXPECT_EQ(cutter.scans()[2].view.measured_frequency_hz(9000), 0.0F);
}

TEST(Scan, IsAConstantExpressionToo) {
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
