// SPDX-License-Identifier: MIT
// Dialogues of each request, also when answers are lost, late, duplicated or wrong.
#include <gtest/gtest.h>

#include <initializer_list>
#include <string>

#include "core/session/played.hpp"
#include "g4lidar/core/session.hpp"

namespace g4lidar::test {
namespace {

constexpr auto clockwise = motor_direction::clockwise;
constexpr auto counter_clockwise = motor_direction::counter_clockwise;

TEST(session_opening, StopsAPossibleScanBeforeTheFirstQuery) {
  played bench;
  EXPECT_ASKED(bench, requests::device_info(),
               ">00 >65 <packet !found_scanning <packet <noise wait >90 <info "
               "=answered:2021101000070073");
  EXPECT_EQ(bench.last.heard, (heard_from_device{3, 1, 2}));
  EXPECT_FALSE(bench.talk.is_scanning());
}

TEST(session_opening, HealthyDevice_Takes50msOfSilence) {
  played bench;
  const std::int64_t begun_ns = bench.now_ns;
  EXPECT_ASKED(bench, requests::start(), ">00 >65 wait >60 <header =answered");
  EXPECT_LE(bench.now_ns - begun_ns, 55 * ms);
}

TEST(session_opening, DeviceThatDoesNotStop_IsStoppedAgainThenGivenUp) {
  played bench;
  std::string script = "<packet";
  for (int i = 0; i < 70; ++i) script += " +19 <packet";
  const std::string went = bench.ask(requests::health(), script);
  std::size_t stops = 0;
  for (std::size_t at = 0; (at = went.find(">00 >65", at)) != std::string::npos; ++at) ++stops;
  EXPECT_EQ(stops, 3U) << went;
  EXPECT_NE(went.find("=still_scanning"), std::string::npos) << went;
  EXPECT_EQ(went.find(">91"), std::string::npos) << went;
  EXPECT_PLAYED(bench, "<packet <packet +5000 <packet");  // no further attempt by itself
}

TEST(session_opening, Noise_DoesNotPreventAQuery) {
  played bench;
  std::string script = ">00 >65";
  for (int i = 0; i < 100; ++i) script += " +20 <noise";
  const std::string went = bench.ask(requests::device_info(), script);
  EXPECT_NE(went.find(">90"), std::string::npos) << went;
}

TEST(session_opening, SilenceNoiseAndImpossibleAnswers_AreDistinguished) {
  played silent;
  EXPECT_ASKED(silent, requests::device_info(),
               ">00 >65 wait >90 wait >91 wait >92 wait >91 wait =timed_out");
  EXPECT_TRUE(silent.last.heard_nothing());
  EXPECT_FALSE(silent.last.heard_noise_only());

  played noisy;
  EXPECT_ASKED(noisy, requests::device_info(),
               ">00 >65 <noise wait >90 <noise wait >91 wait >92 wait >91 wait =timed_out");
  EXPECT_FALSE(noisy.last.heard_nothing());
  EXPECT_TRUE(noisy.last.heard_noise_only());

  played wrong;
  EXPECT_ASKED(wrong, requests::get_ranging(),
               ">00 >65 wait >90 <info >D1 <health:0 >90 wait >91 "
               "wait >90 wait =timed_out");
  EXPECT_EQ(wrong.last.wrong_answers, 1);
  EXPECT_FALSE(wrong.last.heard_noise_only());
}

// ---- queries -----------------------------------------------------------------------------------
TEST_F(session_requests, AreAnsweredInTheirOwnTypes) {
  EXPECT_ASKED(bench, requests::device_info(), ">90 <info =answered:2021101000070073");
  EXPECT_EQ(std::get<device_information>(bench.last.value).model, model_g4);
  EXPECT_ASKED(bench, requests::health(), ">91 <health:1 =answered:1");
  EXPECT_EQ(std::get<health>(bench.last.value), (health{health_status::warning, 0}));
  EXPECT_ASKED(bench, requests::get_low_power(), ">05 <byte:1 =answered:1");
  EXPECT_EQ(std::get<low_power>(bench.last.value), low_power::on);
  EXPECT_ASKED(bench, requests::get_scan_frequency(), ">0D <freq:700 =answered:700");
  EXPECT_EQ(std::get<scan_frequency>(bench.last.value), scan_frequency{700});
  EXPECT_ASKED(bench, requests::get_direction(), ">08 <byte:1 =answered:1");
  EXPECT_EQ(std::get<motor_direction>(bench.last.value), counter_clockwise);
  EXPECT_ASKED(bench, requests::health(), ">91 <health:0 =answered:0");
  EXPECT_ASKED(bench, requests::get_ranging(), ">D1 <byte:2 =answered:2");
  EXPECT_EQ(std::get<ranging_frequency>(bench.last.value), ranging_frequency::khz_9);
}

TEST_F(session_requests, SetByCommandsThatAnswerWithTheSetting) {
  EXPECT_ASKED(bench, requests::set(low_power::on), ">01 <byte:1 =answered:1");
  EXPECT_ASKED(bench, requests::device_info(), ">90 <info =answered:2021101000070073");
  EXPECT_ASKED(bench, requests::set(low_power::off), ">02 <byte:0 =answered:0");
  EXPECT_ASKED(bench, requests::device_info(), ">90 <info =answered:2021101000070073");
  EXPECT_ASKED(bench, requests::set(clockwise), ">06 <byte:0 =answered:0");
  EXPECT_ASKED(bench, requests::device_info(), ">90 <info =answered:2021101000070073");
  EXPECT_ASKED(bench, requests::set(counter_clockwise), ">07 <byte:1 =answered:1");
  EXPECT_ASKED(bench, requests::device_info(), ">90 <info =answered:2021101000070073");
  EXPECT_ASKED(bench, requests::set(constant_frequency::on), ">0E <byte:1 =answered:1");
  EXPECT_ASKED(bench, requests::device_info(), ">90 <info =answered:2021101000070073");
  EXPECT_ASKED(bench, requests::set(constant_frequency::off), ">0F <byte:0 =answered:0");
}

TEST_F(session_requests, HealthFallsBackToTheVendorsCommand) {
  EXPECT_ASKED(bench, requests::health(), ">91 wait >90 <info >92 <health:0 =answered:0");
  EXPECT_EQ(bench.last.retries, 1);
  EXPECT_EQ(bench.talk.retries(), 1U);
}

TEST_F(session_requests, ClearTheLinkAfterALossAndDiscardLateAnswers) {
  EXPECT_ASKED(bench, requests::get_ranging(),
               ">D1 wait >90 <byte:1 <info >D1 <byte:2 =answered:2");
  EXPECT_ASKED(bench, requests::device_info(),
               ">90 wait >91 <info <health:0 >90 <info =answered:2021101000070073");
}

TEST_F(session_requests, ClearTheLinkAfterAnImpossibleAnswer) {
  EXPECT_ASKED(bench, requests::get_low_power(), ">05 <byte:2 >90 <info >05 <byte:0 =answered:0");
  EXPECT_EQ(bench.last.wrong_answers, 1);
  EXPECT_ASKED(bench, requests::get_ranging(),
               ">90 <info >D1 <freq:700 >90 <byte:1 <info >D1 "
               "<byte:2 =answered:2");
  EXPECT_ASKED(bench, requests::device_info(), ">90 <info =answered:2021101000070073");
  EXPECT_ASKED(bench, requests::set(low_power::on),
               ">01 <byte:0 >90 <info >01 <byte:1 =answered:1");
}

TEST_F(session_requests, IgnoreTheSecondCopyOfAnAnswer) {
  EXPECT_ASKED(bench, requests::get_low_power(), ">05 <byte:1 =answered:1");
  // The same kind: the link is cleared first. Another kind: the source is known.
  EXPECT_ASKED(bench, requests::get_ranging(), ">90 <byte:1 <info >D1 <info <byte:2 =answered:2");
}

TEST_F(session_requests, IgnoreAnUnrequestedAnswer) {
  EXPECT_ASKED(bench, requests::health(), ">91 <health:0 =answered:0");
  EXPECT_PLAYED(bench, "<byte:1");
  EXPECT_ASKED(bench, requests::get_ranging(), ">90 <byte:1 <info >D1 <byte:2 =answered:2");
}

TEST_F(session_requests, AlternateTheClearingQueryIfAnswersAreLate) {
  // Each answer arrives 350 ms after its query: the third time the session waits longer.
  EXPECT_ASKED(bench, requests::get_ranging(),
               ">D1 +300 >90 +50 <byte:2 +249 >91 +50 <info +249 >90 +50 <health:0 +299 <info >D1 "
               "+350 <byte:2 =answered:2");
}

TEST_F(session_requests, AreGivenUpAfterFourLossesOrTenSeconds) {
  EXPECT_ASKED(bench, requests::get_direction(),
               ">08 wait >90 <info >08 wait >90 <info >08 wait >90 <info >08 wait >90 <info "
               "=timed_out");
  EXPECT_EQ(bench.last.retries, 3);
  EXPECT_ASKED(bench, requests::get_direction(), ">00 >65 wait >90 <info >08 <byte:0 =answered:0");
  EXPECT_ASKED(bench, requests::get_ranging(),
               ">90 <info >D1 +300 >90 late >91 <health:0 =timed_out");
}

TEST_F(session_requests, AreNotAnsweredBeforeTheyAreSent) {
  session talk;
  const auto next = [&talk] {
    const auto sent = talk.to_send();
    return sent ? (*sent)[1] : 0xFF;
  };
  ASSERT_FALSE(talk.begin(requests::set(ranging_frequency::khz_8), 0));
  EXPECT_EQ(next(), 0x00);
  EXPECT_EQ(next(), 0x65);
  talk.look(50 * ms);
  take_reply(talk, info_reply(), 50 * ms);  // before 90 has been fetched
  EXPECT_EQ(next(), 0x90);
  take_reply(talk, info_reply(), 50 * ms);
  EXPECT_EQ(next(), 0xD1);
  take_reply(talk, byte_reply(2), 50 * ms);
  take_reply(talk, byte_reply(2), 50 * ms);  // the second copy, in the same read as the first
  EXPECT_EQ(next(), 0xD0);
  EXPECT_EQ(next(), 0xFF);
}

TEST(session_patience, FirstAnswer_MayTakeASecond) {
  played bench;
  EXPECT_ASKED(bench, requests::device_info(),
               ">00 >65 wait >90 +990 <info =answered:2021101000070073");
  EXPECT_ASKED(bench, requests::health(), ">91 +990 <health:0 =answered:0");  // a slow device
  EXPECT_ASKED(bench, requests::get_ranging(), ">D1 <byte:2 =answered:2");    // a quick one again
  const std::int64_t asked_ns = bench.now_ns;
  EXPECT_ASKED(bench, requests::get_low_power(),
               ">90 <info >05 wait >90 <info >05 <byte:1 =answered:1");
  EXPECT_EQ(bench.now_ns - asked_ns, 303 * ms);
}

TEST(session_patience, DeviceThatNeverAnswers_Ends) {
  played bench;
  const std::int64_t asked_ns = bench.now_ns;
  EXPECT_ASKED(bench, requests::device_info(),
               ">00 >65 wait >90 wait >91 wait >92 wait >91 wait =timed_out");
  EXPECT_EQ(bench.now_ns - asked_ns, (50 + 1000 + 300 + 300 + 600) * ms);
}

TEST_F(session_requests, ImpossibleValue_IsRefusedBeforeSending) {
  const auto bad = [](auto value) { return static_cast<decltype(value)>(77); };
  for (const request& wanted : std::initializer_list<request>{
           requests::set(scan_frequency{1500}), requests::set(scan_frequency{1201}),
           requests::set(scan_frequency{499}), requests::set(scan_frequency{10}),
           requests::set(bad(low_power::on)), requests::set(bad(motor_direction::clockwise)),
           requests::set(bad(constant_frequency::on)), requests::set(bad(ranging_frequency::khz_4)),
           requests::set(bad(power_down_protection::on)),
           requests::step(bad(frequency_step::up_1_hz)), request{static_cast<request_kind>(77)},
           request{request_kind::health, 1}}) {
    EXPECT_ASKED(bench, wanted, "bad_setting");
    EXPECT_FALSE(bench.talk.is_busy());
  }
}

// ---- restart -----------------------------------------------------------------------------------
TEST_F(session_requests, Restart_EndsWhenTheDeviceAnswers) {
  EXPECT_ASKED(bench, requests::restart(), ">80 +300 <noise <noise <info wait >90 <info =answered");
  EXPECT_ASKED(bench, requests::restart(),  // silent for a while after its text
               ">80 +300 <noise wait >90 wait >90 <noise <info =answered");
}

TEST_F(session_requests, Restart_MayBeFollowedByADeviceInformation) {
  EXPECT_ASKED(bench, requests::health(), ">91 <health:0 =answered:0");
  EXPECT_ASKED(bench, requests::restart(), ">80 <noise wait >90 <info =answered");
  EXPECT_ASKED(bench, requests::get_ranging(), ">D1 <info <byte:2 =answered:2");
  EXPECT_EQ(bench.last.wrong_answers, 0);
}

TEST_F(session_requests, RestartWithoutReaction_SendsTheOldCommand) {
  EXPECT_ASKED(bench, requests::restart(), ">80 wait >40 <noise wait >90 <info =answered");
  EXPECT_ASKED(bench, requests::restart(), ">80 wait >40 wait >90 <info =answered");
}

TEST_F(session_requests, RestartOfAMissingDevice_Ends) {
  const std::int64_t begun_ns = bench.now_ns;
  std::string went = bench.ask(requests::restart(), ">80 wait >40 wait >90");
  while (bench.talk.is_busy()) went = bench.play("wait");
  EXPECT_EQ(went, "wait =timed_out");
  EXPECT_LE(bench.now_ns - begun_ns, 6000 * ms);
}

}  // namespace
}  // namespace g4lidar::test
