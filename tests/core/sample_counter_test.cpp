// SPDX-License-Identifier: MIT
// Lost samples, counted by the angle between packets.
#include "g4lidar/core/clock/sample_counter.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace g4lidar {
namespace {

/// A motor that turns by 16/64 degree per sample, and packets of 40 samples.
class SampleCounter : public testing::Test {
 protected:
  static decoded packet(int samples, int first_64ths, int span_64ths) {
    decoded result;
    result.sample_count = static_cast<std::uint16_t>(samples);
    result.first_angle_64ths = static_cast<std::uint16_t>(first_64ths % turn_64ths);
    result.span_64ths = static_cast<std::int16_t>(span_64ths);
    return result;
  }
  /// The packet after `skipped` more samples.
  decoded after(int skipped, int samples = 40) {
    at_ += 16 * skipped;
    const decoded result = packet(samples, at_, 16 * (samples - 1));
    at_ += 16 * samples;
    return result;
  }
  sample_gap next(const decoded& p, bool hinted = false, double late = 0.0) {
    return counter_.next(p, hinted, late);
  }
  void settle(int packets = 100) {
    for (int i = 0; i < packets; ++i) ASSERT_EQ(next(after(0)).lost, 0);
  }

  sample_counter counter_;
  int at_ = 5000;
};

TEST_F(SampleCounter, LearnsTheStep) {
  settle();
  EXPECT_NEAR(counter_.step_64ths(), 16.0, 0.01);
}

TEST_F(SampleCounter, CountsAnyGapBelowSevenEighthsOfATurn) {
  settle();
  for (const int lost : {1, 2, 39, 40, 80, 400, 1000, 1200}) {
    const sample_gap gap = next(after(lost), true);
    EXPECT_EQ(gap.lost, lost);
    EXPECT_TRUE(gap.known);
    settle(20);
  }
}

TEST_F(SampleCounter, CountsWithoutAHint) {
  settle();
  EXPECT_EQ(next(after(40)).lost, 40);
  EXPECT_EQ(next(after(1)).lost, 1);  // a zero packet
}

TEST_F(SampleCounter, AddsTurnsOnlyIfThePacketIsLate) {
  settle();
  EXPECT_EQ(next(after(1440 + 100), true, 0.0).lost, 100);
  EXPECT_EQ(next(after(1440 + 100), true, 1440 + 100 + 140).lost, 1540);
  EXPECT_EQ(next(after(2 * 1440), true, 2 * 1440 + 1).lost, 2880);
  EXPECT_EQ(next(after(3 * 1440 - 5), true, 3 * 1440).lost, 4315);
  EXPECT_EQ(next(after(1440 + 700), true, 1440 + 690).lost, 2140);  // the rates differ a little
}

TEST_F(SampleCounter, LongGaps_AreUncertain) {
  settle();
  EXPECT_EQ(next(after(80), true).doubt_samples, 0.0);
  EXPECT_GT(next(after(1200), true).doubt_samples, 0.5);
  EXPECT_GT(next(after(14400), true, 14400.0).doubt_samples, 10.0);
}

TEST_F(SampleCounter, SmallStepsOfAnUnevenMotor_AreNoLoss) {
  settle();
  for (int i = 0; i < 200; ++i) {
    decoded p = after(0);
    p.first_angle_64ths = static_cast<std::uint16_t>(p.first_angle_64ths + (i % 2) * 8);
    p.span_64ths = static_cast<std::int16_t>(p.span_64ths - (i % 2) * 8);
    EXPECT_EQ(next(p).lost, 0);
  }
  EXPECT_EQ(next(after(1)).lost, 0);  // too small to decide
  EXPECT_EQ(next(after(40)).lost, 40);
}

TEST_F(SampleCounter, StepBack_IsNoLoss) {
  settle();
  at_ -= 300;
  EXPECT_EQ(next(after(0)).lost, 0);
}

TEST_F(SampleCounter, SuspectPacket_DoesNotInterruptCounting) {
  settle();
  decoded suspect = after(0);
  suspect.suspect = true;
  suspect.span_64ths = -20;
  EXPECT_EQ(next(suspect).lost, 0);
  EXPECT_EQ(next(after(40)).lost, 40);
}

TEST_F(SampleCounter, StoppedMotor_IsNotKnown) {
  for (int i = 0; i < 20; ++i) {
    const sample_gap gap = next(packet(40, 1000, 0));
    EXPECT_EQ(gap.lost, 0);
    EXPECT_TRUE(gap.known);
  }
  EXPECT_EQ(counter_.step_64ths(), 0.0);
  EXPECT_FALSE(next(packet(40, 1000, 0), true).known);
}

// Bytes were skipped, the packet is late by more than half a turn, and the head has moved back.
TEST_F(SampleCounter, LossIsNeverNegative) {
  settle();
  at_ -= 300;
  EXPECT_EQ(next(after(0), true, 864.0).lost, 0);
}

// A motor that gains 28 Hz a second, measured at 4 kHz, 80 samples a packet: from packet to packet it
// turns faster by 3/64 degree a sample. The index, where the short packets are, comes at any moment.
TEST_F(SampleCounter, MotorThatSpinsUp_IsNotALoss) {
  for (int way_to_index = 1; way_to_index <= 2000; ++way_to_index) {
    sample_counter counter;
    const double begin_64ths = turn_64ths - way_to_index / 4.0;
    double at = begin_64ths;
    int samples = 0;
    for (int i = 0; i < 12; ++i) {
      const double step = 28.0 * samples / 4000.0 * turn_64ths / 4000.0;
      const bool is_zero = at >= turn_64ths && at - step < turn_64ths && i > 0;
      int count = 0;
      const double first = at;
      double last = at;
      do {
        last = at;
        at += step;
        ++count;
      } while (count < (is_zero ? 1 : 80) && (last >= turn_64ths || at < turn_64ths));
      samples += count;
      const int rounded = static_cast<int>(first + 0.5);
      const sample_gap gap =
          counter.next(packet(count, rounded, static_cast<int>(last + 0.5) - rounded), false, 0.0);
      ASSERT_EQ(gap.lost, 0) << way_to_index << ", packet " << i;
    }
  }
}

TEST_F(SampleCounter, Reset_Forgets) {
  settle();
  counter_.reset();
  EXPECT_EQ(counter_.step_64ths(), 0.0);
  EXPECT_EQ(next(after(400)).lost, 0);
}

}  // namespace
}  // namespace g4lidar
