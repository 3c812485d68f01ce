// SPDX-License-Identifier: MIT
// Requests that need commands that change state: sample rate, frequency, protection.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/session/played.hpp"
#include "g4lidar/core/session.hpp"

namespace g4lidar::test {
namespace {

TEST_F(session_requests, SampleRate_StepsAndReadsOnceMore) {
  EXPECT_ASKED(bench, requests::set(sample_rate::khz_8),
               ">D1 <byte:2 >D0 <byte:0 >D0 <byte:1 >90 <info >D1 <byte:1 =answered:1");
  EXPECT_ASKED(bench, requests::set(sample_rate::khz_8),
               ">90 <info >D1 <byte:1 >90 <info >D1 <byte:1 =answered:1");
}

TEST_F(session_requests, SampleRateAfterALoss_IsQueriedAndNotSteppedAgain) {
  // The step was executed, its answer lost.
  EXPECT_ASKED(bench, requests::set(sample_rate::khz_9),
               ">D1 <byte:1 >D0 wait >90 <info >D1 <byte:2 >90 <info >D1 <byte:2 =answered:2");
  // The step itself was lost.
  EXPECT_ASKED(bench, requests::set(sample_rate::khz_4),
               ">90 <info >D1 <byte:2 >D0 wait >90 <info >D1 <byte:2 >D0 <byte:0 >90 <info >D1 "
               "<byte:0 =answered:0");
}

TEST_F(session_requests, SampleRate_IgnoresACopyOfTheLastAnswer) {
  EXPECT_ASKED(bench, requests::set(sample_rate::khz_8),
               ">D1 <byte:2 >D0 <byte:2 >90 <byte:0 <info >D1 <byte:0 >D0 <byte:0 >90 <byte:1 "
               "<info >D1 <byte:1 >90 <info >D1 <byte:1 =answered:1");
}

TEST_F(session_requests, SampleRateWithoutEffect_IsNotReached) {
  EXPECT_ASKED(bench, requests::set(sample_rate::khz_4),
               ">D1 <byte:2 >D0 <byte:2 >90 <info >D1 <byte:2 =not_reached:2");
}

TEST_F(session_requests, EndIfNoChangeIsKept) {
  std::string went = bench.ask(requests::set(sample_rate::khz_9), "<byte:0");
  int moves = 0;
  unsigned now = 0;
  for (int i = 0; i < 1000 && bench.talk.is_busy(); ++i) {
    const std::string asked = went.substr(went.size() - 3);
    if (asked == ">D0") {
      ++moves;
      now = (now + 1) % 3;
    } else if (asked == ">D1") {
      now = 0;  // it returns another value each time it is queried
    }
    went = bench.play(asked == ">90" ? "<info" : "<byte:" + std::to_string(now));
  }
  EXPECT_EQ(moves, 60);
  EXPECT_EQ(bench.last.how, verdict::not_reached);
}

TEST_F(session_requests, Frequency_IsSteppedCoarselyThenFinely) {
  EXPECT_ASKED(bench, requests::set(scan_frequency{920}),
               ">0D <freq:700 >0B <freq:800 >0B <freq:900 >09 <freq:910 >09 <freq:920 >90 <info "
               ">0D <freq:920 =answered:920");
  EXPECT_ASKED(bench, requests::set(scan_frequency{793}),
               ">90 <info >0D <freq:920 >0C <freq:820 >0A <freq:810 >0A <freq:800 >0A <freq:790 "
               ">90 <info >0D <freq:790 =answered:790");
}

TEST_F(session_requests, FrequencyAfterALoss_IsQueriedAndContinues) {
  EXPECT_ASKED(bench, requests::set(scan_frequency{800}),
               ">0D <freq:700 >0B wait >90 <freq:800 <info >0D <freq:800 >90 <info >0D <freq:800 "
               "=answered:800");
  EXPECT_ASKED(bench, requests::set(scan_frequency{900}),
               ">90 <info >0D <freq:800 >0B wait >90 <info >0D <freq:800 >0B <freq:900 >90 <info "
               ">0D <freq:900 =answered:900");
}

TEST_F(session_requests, Frequency_StopsAtTheEndOfTheRange) {
  // One device goes to its limit, another stays before it; steps of 0.1 Hz may still lead there.
  EXPECT_ASKED(bench, requests::set(scan_frequency{1200}),
               ">0D <freq:1050 >0B <freq:1100 >0B <freq:1100 >90 <info >0D <freq:1100 >09 "
               "<freq:1100 >90 <info >0D <freq:1100 =not_reached:1100");
  EXPECT_ASKED(
      bench, requests::set(scan_frequency{1200}),
      ">90 <info >0D <freq:1090 >0B <freq:1090 >90 <info >0D <freq:1090 >09 <freq:1100 >09 "
      "<freq:1100 >90 <info >0D <freq:1100 =not_reached:1100");
  // Without any answer it is tried three times.
  EXPECT_ASKED(bench, requests::set(scan_frequency{710}),
               ">90 <info >0D <freq:700 >09 wait >90 <info >0D <freq:700 >09 wait >90 <info >0D "
               "<freq:700 >09 wait >90 <info >0D <freq:700 =not_reached:700");
  // Some devices refuse a last step of less than 0.1 Hz: that is as near as possible.
  EXPECT_ASKED(bench, requests::set(scan_frequency{500}),
               ">90 <info >0D <freq:508 >0A <freq:508 >90 <info >0D <freq:508 =answered:508");
}

TEST_F(session_requests, Frequency_NeedsTwoEqualAnswers) {
  EXPECT_ASKED(bench, requests::set(scan_frequency{710}),
               ">0D <freq:710 >90 <info >0D <freq:700 >09 <freq:710 >90 <info >0D <freq:710 "
               "=answered:710");
}

TEST_F(session_requests, OneStep_IsSentOnce) {
  EXPECT_ASKED(bench, requests::step(frequency_step::up_1_hz),
               ">0D <freq:700 >0B <freq:800 >90 <info >0D <freq:800 =answered:800");
  EXPECT_ASKED(bench, requests::step(frequency_step::down_0_1_hz),
               ">90 <info >0D <freq:800 >0A wait >90 <info >0D <freq:790 >90 <info >0D <freq:790 "
               "=answered:790");
  EXPECT_ASKED(bench, requests::step(frequency_step::up_1_hz),
               ">90 <info >0D <freq:1200 >0B <freq:1200 >90 <info >0D <freq:1200 =answered:1200");
}

TEST_F(session_requests, Protection_IsToggledUntilItIsAsWanted) {
  EXPECT_ASKED(bench, requests::set(power_down_protection::on), ">D9 <byte:0 =answered:0");
  EXPECT_EQ(bench.talk.protection(), power_down_protection::on);
  EXPECT_ASKED(bench, requests::set(power_down_protection::on),
               ">90 <info >D9 <byte:1 >D9 <byte:0 =answered:0");
  EXPECT_ASKED(bench, requests::set(power_down_protection::off),
               ">90 <info >D9 <byte:1 =answered:1");
  EXPECT_EQ(bench.talk.protection(), power_down_protection::off);
}

TEST_F(session_requests, Protection_IsToggledAgainOnlyAfterAClearLink) {
  EXPECT_ASKED(bench, requests::set(power_down_protection::on),
               ">D9 wait >90 <info >D9 <byte:1 >D9 <byte:0 =answered:0");
  // A second, equal answer is a copy of the first.
  EXPECT_ASKED(bench, requests::set(power_down_protection::on),
               ">90 <info >D9 <byte:1 >D9 <byte:1 >90 <byte:0 <info >D9 <byte:1 >D9 <byte:0 "
               "=answered:0");
  EXPECT_ASKED(bench, requests::set(power_down_protection::on),
               ">90 <info >D9 wait >90 <info >D9 wait >90 <info >D9 wait >90 <info >D9 wait >90 "
               "<info =timed_out");
  EXPECT_EQ(bench.talk.protection(), std::nullopt);
}

/// The number of D9 that were sent to a device that answers each with the next of `answers`, then
/// repeats.
int toggles(played& bench, const std::vector<int>& answers) {
  int sent = 0;
  std::string went = bench.ask(requests::set(power_down_protection::on), "");
  for (int i = 0; i < 1000 && bench.talk.is_busy(); ++i) {
    const bool is_toggle = went.ends_with(">D9");
    if (is_toggle) ++sent;
    const int value = answers[static_cast<std::size_t>(sent - 1) % answers.size()];
    went = bench.play(is_toggle               ? std::string("<byte:").append(std::to_string(value))
                      : went.ends_with(">90") ? "<info"
                                              : "wait");
  }
  EXPECT_FALSE(bench.talk.is_busy());
  return sent;
}

TEST_F(session_requests, Protection_IsToggledABoundedNumberOfTimes) {
  for (const std::vector<int>& answers :
       std::vector<std::vector<int>>{{2}, {1}, {1, 1, 2}, {2, 1, 1}}) {
    EXPECT_LE(toggles(bench, answers), 8);
    EXPECT_EQ(bench.last.how, verdict::timed_out);
  }
}

}  // namespace
}  // namespace g4lidar::test
