// SPDX-License-Identifier: MIT
// Lost samples, counted by the angle that was passed over.
#include "g4lidar/sample_counter.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace g4lidar {
namespace {

/// A motor that turns by 16/64 degree in a sample, and packets of 40 samples of it.
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

TEST_F(SampleCounter, AddsTurnsOnlyIfToldThatThereWasTime) {
  settle();
  EXPECT_EQ(next(after(1440 + 100), true, 0.0).lost, 100);
  EXPECT_EQ(next(after(1440 + 100), true, 1440 + 100 + 140).lost, 1540);
  EXPECT_EQ(next(after(2 * 1440), true, 2 * 1440 + 1).lost, 2880);
  EXPECT_EQ(next(after(3 * 1440 - 5), true, 3 * 1440).lost, 4315);
  EXPECT_EQ(next(after(1440 + 700), true, 1440 + 690).lost, 2140);  // rates differ a little
}

TEST_F(SampleCounter, DoubtsLongGaps) {
  settle();
  EXPECT_EQ(next(after(80), true).doubt_samples, 0.0);
  EXPECT_GT(next(after(1200), true).doubt_samples, 0.5);
  EXPECT_GT(next(after(14400), true, 14400.0).doubt_samples, 10.0);
}

TEST_F(SampleCounter, TakesSmallStepsOfARoughMotorForNoLoss) {
  settle();
  for (int i = 0; i < 200; ++i) {
    decoded p = after(0);
    p.first_angle_64ths = static_cast<std::uint16_t>(p.first_angle_64ths + (i % 2) * 8);
    p.span_64ths = static_cast<std::int16_t>(p.span_64ths - (i % 2) * 8);
    EXPECT_EQ(next(p).lost, 0);
  }
  EXPECT_EQ(next(after(1)).lost, 0);  // too small to tell
  EXPECT_EQ(next(after(40)).lost, 40);
}

TEST_F(SampleCounter, TakesAStepBackForNoLoss) {
  settle();
  at_ -= 300;
  EXPECT_EQ(next(after(0)).lost, 0);
}

TEST_F(SampleCounter, CountsOnThroughASuspectPacket) {
  settle();
  decoded suspect = after(0);
  suspect.suspect = true;
  suspect.span_64ths = -20;
  EXPECT_EQ(next(suspect).lost, 0);
  EXPECT_EQ(next(after(40)).lost, 40);
}

TEST_F(SampleCounter, KnowsNothingWhileTheMotorStands) {
  for (int i = 0; i < 20; ++i) {
    const sample_gap gap = next(packet(40, 1000, 0));
    EXPECT_EQ(gap.lost, 0);
    EXPECT_TRUE(gap.known);
  }
  EXPECT_EQ(counter_.step_64ths(), 0.0);
  EXPECT_FALSE(next(packet(40, 1000, 0), true).known);
}

TEST_F(SampleCounter, Forgets) {
  settle();
  counter_.reset();
  EXPECT_EQ(counter_.step_64ths(), 0.0);
  EXPECT_EQ(next(after(400)).lost, 0);
}

}  // namespace
}  // namespace g4lidar
