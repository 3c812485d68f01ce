// SPDX-License-Identifier: MIT
// Revolutions: where they are cut, their flags, and that no point is lost.
#include "g4lidar/core/scan_assembler.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <vector>

#include "turned_scans.hpp"

namespace g4lidar {
namespace {

using namespace test;

TEST(Scan, FirstScan_IsPartial_NextAreWhole) {
  scan_cutter cutter(1000);
  turn(cutter, 260, 360);
  for (int i = 0; i < 3; ++i) {
    zero(cutter);
    turn(cutter, 0, 360);
  }
  EXPECT_EQ(marks_of(cutter), (all_marks{start_missing, whole, whole}));
  EXPECT_EQ(sizes_of(cutter), (all_sizes{200, 721, 721}));
  cutter.finish();
  EXPECT_EQ(cutter.scans().back().view.flags, end_missing);
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

TEST(Scan, LostZeroPacket_CutsByTheAngle) {
  scan_cutter cutter(2000);
  zero(cutter);
  turn(cutter, 0, 720);  // the zero packet at 360 is missing
  zero(cutter);
  turn(cutter, 0, 360);
  zero(cutter);
  EXPECT_EQ(marks_of(cutter), (all_marks{end_by_angle, start_by_angle, whole}));
  EXPECT_EQ(sizes_of(cutter), (all_sizes{1 + 720, 720, 721}));
  for (const kept_scan& kept : cutter.scans()) EXPECT_FALSE(kept.view.is_piece());
  EXPECT_FALSE(cutter.scans()[0].view.is_whole());
  EXPECT_EQ(cutter.scans()[0].view.revolution, 0U);
  EXPECT_EQ(cutter.scans()[1].view.revolution, 0U);
  EXPECT_EQ(cutter.scans()[2].view.revolution, 1U);
  EXPECT_FLOAT_EQ(cutter.scans()[0].view.turned_deg, 360.0F);
  EXPECT_FLOAT_EQ(cutter.scans()[1].view.turned_deg, 360.0F);
  cutter.finish();
  EXPECT_EQ(cutter.came_out(), cutter.put_in());
}

TEST(Scan, NoZeroPacket_CountsTurnsFromTheFirstPoint) {
  scan_cutter cutter(5000);
  turn(cutter, 100, 100 + 10 * 360);
  cutter.finish();
  ASSERT_EQ(cutter.scans().size(), 10U);
  EXPECT_EQ(sizes_of(cutter), all_sizes(10, 720));
  EXPECT_EQ(cutter.scans()[0].view.flags, start_missing | end_by_angle);
  for (std::size_t i = 1; i < 9; ++i) {
    EXPECT_EQ(cutter.scans()[i].view.flags, start_by_angle | end_by_angle);
  }
  EXPECT_EQ(cutter.scans()[9].view.flags, start_by_angle | end_missing);
  EXPECT_EQ(cutter.came_out(), cutter.put_in());
}

TEST(Scan, ZeroPacketHalfADegreeLate_IsNotLost) {
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

TEST(Scan, FullStorage_CutsAndLosesNothing) {
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

TEST(Scan, StorageOfOneRevolution_IsSufficient) {
  scan_cutter cutter(721);
  for (int i = 0; i < 3; ++i) {
    zero(cutter);
    turn(cutter, 0, 360);
  }
  EXPECT_EQ(marks_of(cutter), (all_marks{whole, whole}));
}

TEST(Scan, StorageOfOnePoint_LosesNothing) {
  scan_cutter cutter(1);
  zero(cutter);
  turn(cutter, 0, 20);
  zero(cutter);
  cutter.finish();
  EXPECT_EQ(cutter.scans().size(), 42U);
  EXPECT_EQ(cutter.came_out(), cutter.put_in());
}

TEST(Scan, SuspectPacket_FlagsItsScan) {
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

TEST(Scan, SuspectZeroPacket_StartsARevolution) {
  scan_cutter cutter(1000);
  zero(cutter);
  turn(cutter, 0, 360);
  suspect(cutter, 10, 1 | 65U << 1, 4);
  turn(cutter, 10, 360);
  zero(cutter);
  EXPECT_EQ(marks_of(cutter), (all_marks{whole, data_lost}));
  EXPECT_EQ(cutter.scans()[1].view.revolution, 1U);
  EXPECT_EQ(cutter.scans()[1].view.suspect_samples, 4U);
  EXPECT_EQ(cutter.scans()[1].view.reported_frequency_chz, 650);
  EXPECT_EQ(cutter.scans()[1].points.size(), 700U);
}

// The zero packets of a TG contain 3 Hz less than the motor turns; 0 means that they report nothing.
TEST(Scan, ReportedFrequency_IsThatOfTheModel) {
  const auto reported = [](const char* model, unsigned ct_chz) {
    std::vector<point> storage(100);
    scan_assembler assembler(storage, *model_named(model));
    for (int i = 0; i < 2; ++i) {
      const point one;
      decoded packet;
      packet.points = {&one, 1};
      packet.sample_count = 1;
      packet.reported_frequency_chz = static_cast<std::uint16_t>(ct_chz);
      packet.starts_revolution = true;
      while (const auto found = assembler.next(packet)) return int{found->reported_frequency_chz};
    }
    return -1;
  };
  EXPECT_EQ(reported("tg30", 400), 700);
  EXPECT_EQ(reported("tg30", 0), 0);
  EXPECT_EQ(reported("g4", 700), 700);
  EXPECT_EQ(reported("tg30", 1270), 1570);
}

TEST(Scan, OnlySuspectPackets_GiveAScanWithoutPoints) {
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

TEST(Scan, Loss_FlagsItsScan) {
  scan_cutter cutter(1000);
  cutter.lost();  // before the first point: no scan's loss
  zero(cutter);
  turn(cutter, 0, 360);
  zero(cutter);
  turn(cutter, 0, 200);
  cutter.lost();
  turn(cutter, 220, 360);
  zero(cutter);
  turn(cutter, 0, 360);
  cutter.lost();  // up to the zero packet: a loss of the ending scan
  zero(cutter);
  cutter.lost();  // from the zero packet on: a loss of the beginning scan
  turn(cutter, 10, 360);
  zero(cutter);
  EXPECT_EQ(marks_of(cutter), (all_marks{whole, data_lost, data_lost, data_lost}));
}

TEST(Scan, SkippedBytes_AreALossIfLongEnoughForAPacket) {
  const auto marks_after = [](const std::vector<skipped>& gone) {
    scan_cutter cutter(1000);
    zero(cutter);
    turn(cutter, 0, 180);
    for (const skipped& each : gone) cutter.add(each);
    turn(cutter, 180, 360);
    zero(cutter);
    return cutter.scans().at(0).view.flags;
  };
  EXPECT_EQ(marks_after({{1, skip_reason::bad_header}}), data_lost);
  EXPECT_EQ(marks_after({{1, skip_reason::bad_checksum}}), data_lost);
  EXPECT_EQ(marks_after({{1, skip_reason::truncated}}), data_lost);
  // A packet whose first byte is damaged, in one piece and in many; and less than a packet.
  EXPECT_EQ(marks_after({{50, skip_reason::noise}}), data_lost);
  EXPECT_EQ(marks_after(std::vector<skipped>(11, {1, skip_reason::noise})), data_lost);
  EXPECT_EQ(marks_after({{10, skip_reason::noise}}), whole);
}

TEST(Scan, StrayBytes_AreNotSummedAcrossPackets) {
  scan_cutter cutter(1000);
  zero(cutter);
  for (int deg = 0; deg < 360; deg += 10) {
    cutter.add({1, skip_reason::noise});
    turn(cutter, deg, deg + 10);
  }
  zero(cutter);
  EXPECT_EQ(marks_of(cutter), (all_marks{whole}));
}

TEST(Scan, LossAcrossAZeroPacket_CutsByTheAngle) {
  scan_cutter cutter(2000);
  zero(cutter);
  turn(cutter, 0, 300);
  cutter.lost();
  turn(cutter, 400, 720);
  zero(cutter);
  EXPECT_EQ(marks_of(cutter), (all_marks{end_by_angle | data_lost, start_by_angle | data_lost}));
  EXPECT_EQ(sizes_of(cutter), (all_sizes{601, 640}));
  EXPECT_FLOAT_EQ(cutter.scans()[0].view.turned_deg, 400.0F);
}

TEST(Scan, GapsBelowSevenEighthsOfATurn_AreFollowed) {
  for (const int gap : {20, 90, 180, 270, 310}) {
    scan_cutter cutter(1000);
    zero(cutter);
    turn(cutter, 0, 20);
    turn(cutter, 20 + gap, 360);
    zero(cutter);
    ASSERT_EQ(cutter.scans().size(), 1U);
    EXPECT_EQ(cutter.scans()[0].view.flags, whole) << gap;
    EXPECT_FLOAT_EQ(cutter.scans()[0].view.turned_deg, 360.0F) << gap;
  }
}

TEST(Scan, SmallStepsBack_AreNotATurn) {
  scan_cutter cutter(2000);
  zero(cutter);
  turn(cutter, 0, 180);
  turn(cutter, 150, 200);  // the motor went back by 30 degrees
  turn(cutter, 160, 360);
  zero(cutter);
  EXPECT_EQ(marks_of(cutter), (all_marks{whole}));
  EXPECT_FLOAT_EQ(cutter.scans()[0].view.turned_deg, 360.0F);
}

TEST(Scan, PacketAcrossNearlyAFullTurn_IsFollowed) {
  scan_cutter cutter(2000);
  zero(cutter);
  const made::packet wide(0, 0, 350 * 64, 80);  // LSA >= FSA is used unchanged
  cutter.feed(wide.view());
  turn(cutter, 360, 370);
  zero(cutter, 10);
  ASSERT_EQ(cutter.scans().size(), 2U);
  EXPECT_EQ(marks_of(cutter), (all_marks{end_by_angle, start_by_angle | turn_short}));
  EXPECT_EQ(sizes_of(cutter), (all_sizes{81, 20}));
}

TEST(Scan, CutInsideAWidePacket) {
  scan_cutter cutter(2000);
  zero(cutter, 300);
  turn(cutter, 300, 600);
  const made::packet wide(0, 240 * 64, 319 * 64, 80);  // a sample per degree; the turn ends at 301
  cutter.feed(wide.view());
  cutter.finish();
  EXPECT_EQ(sizes_of(cutter), (all_sizes{1 + 600 + 60, 20}));
  EXPECT_EQ(cutter.came_out(), cutter.put_in());
}

}  // namespace
}  // namespace g4lidar
