// SPDX-License-Identifier: MIT
// Starts, keep-alives, stops, and the reaction of a session to scans that begin or end by
// themselves.
#include <gtest/gtest.h>

#include <array>
#include <initializer_list>
#include <string>

#include "core/session/played.hpp"
#include "g4lidar/core/session.hpp"

namespace g4lidar::test {
namespace {

constexpr std::array<std::uint8_t, 7> scan_header{0xA5, 0x5A, 0x05, 0, 0, 0x40, 0x81};

constexpr command next_of(session& talk) {
  const auto sent = talk.to_send();
  return sent ? static_cast<command>((*sent)[1]) : command::device_info;
}

/// From an unknown device to a running scan.
constexpr bool starts() {
  session talk;
  if (talk.begin(requests::start(), 0)) return false;
  if (next_of(talk) != command::forced_stop || next_of(talk) != command::stop) return false;
  if (talk.next_look_ns() != 50'000'000 || talk.finished()) return false;
  talk.look(50'000'000);
  if (next_of(talk) != command::start || talk.to_send()) return false;
  take_reply(talk, scan_header, 52'000'000);
  const auto done = talk.finished();
  return done && done->how == verdict::answered && talk.is_scanning() && !talk.is_busy();
}
static_assert(starts(), "a session is usable at compile time");
static_assert(std::is_trivially_copyable_v<session>);

class session_scanning : public ::testing::Test {
 protected:
  session_scanning() {
    EXPECT_ASKED(bench, requests::device_info(),
                 ">00 >65 wait >90 <info =answered:2021101000070073");
  }
  void start() { EXPECT_ASKED(bench, requests::start(), ">60 <header =answered <packet"); }
  void protect() {
    EXPECT_ASKED(bench, requests::set(power_down_protection::on), ">D9 <byte:0 =answered:0");
  }
  /// That many packets, one every 100 ms; returns what the session does.
  std::string packets(int count) {
    std::string all;
    for (int i = 0; i < count; ++i) {
      const std::string went = bench.play("+99 <packet");
      if (went != "+99 <packet") all += (all.empty() ? "" : " ") + went;
    }
    return all;
  }
  played bench;
};

TEST_F(session_scanning, BeginsWithTheHeaderOrAPacket) {
  start();
  EXPECT_TRUE(bench.talk.is_scanning());
  EXPECT_ASKED(bench, requests::stop(), ">00 >65 <packet <noise wait =answered");
  EXPECT_FALSE(bench.talk.is_scanning());
  EXPECT_ASKED(bench, requests::start(), ">60 <packet =answered");
}

TEST_F(session_scanning, UnansweredStart_IsRepeatedAfterAStop) {
  EXPECT_ASKED(bench, requests::start(), ">60 wait >00 >65 wait >60 <header =answered");
}

TEST_F(session_scanning, Start_IsGivenUpWithAStop) {
  EXPECT_ASKED(bench, requests::start(),
               ">60 wait >00 >65 wait >60 wait >00 >65 wait >60 wait >00 >65 =timed_out");
  EXPECT_FALSE(bench.talk.is_scanning());
  EXPECT_TRUE(bench.last.heard_nothing());
}

TEST_F(session_scanning, StartDuringAScan_IsAnsweredImmediately) {
  start();
  EXPECT_ASKED(bench, requests::start(), "=answered");
}

TEST_F(session_scanning, StopOfAnIdleDevice_Takes50ms) {
  const std::int64_t begun_ns = bench.now_ns;
  EXPECT_ASKED(bench, requests::stop(), ">00 >65 wait =answered");
  EXPECT_EQ(bench.now_ns - begun_ns, 50 * ms);
}

TEST_F(session_scanning, StopIsRepeatedUntilThereIsSilence) {
  start();
  std::string script = ">00 >65";
  for (int i = 0; i < 10; ++i) script += " +39 <packet";
  script += " wait >00 >65 <packet wait =answered";
  EXPECT_ASKED(bench, requests::stop(), script);
}

TEST_F(session_scanning, RefusesWhatWouldDisturbTheStream) {
  start();
  for (const request& wanted : std::initializer_list<request>{
           requests::device_info(), requests::health(), requests::get_low_power(),
           requests::set(low_power::on), requests::restart(), requests::get_sample_rate(),
           requests::set(power_down_protection::on), requests::set(scan_frequency{800})}) {
    EXPECT_ASKED(bench, wanted, "scanning");
  }
  EXPECT_TRUE(bench.talk.is_scanning());
  EXPECT_ASKED(bench, requests::stop(), ">00 >65 wait =answered");
  EXPECT_ASKED(bench, requests::health(), ">91");
  EXPECT_ASKED(bench, requests::stop(), "busy");
}

TEST_F(session_scanning, StopAndResume_StopsAsksAndResumes) {
  start();
  EXPECT_EQ(bench.ask(requests::health(), "<packet wait <health:0 <header",
                      while_scanning::stop_and_resume),
            ">00 >65 <packet wait >91 <health:0 >60 <header =answered:0");
  EXPECT_TRUE(bench.talk.is_scanning());
}

TEST_F(session_scanning, ResumesAfterAnUnansweredRequest) {
  start();
  EXPECT_EQ(bench.ask(requests::health(), "wait wait wait wait wait wait <header",
                      while_scanning::stop_and_resume),
            ">00 >65 wait >91 wait >90 wait >90 wait >90 wait >00 >65 wait >60 <header =timed_out");
  EXPECT_TRUE(bench.talk.is_scanning());
}

TEST_F(session_scanning, ReportsAFailedResume) {
  start();
  EXPECT_EQ(bench.ask(requests::health(), "wait <health:0 wait wait wait wait wait",
                      while_scanning::stop_and_resume),
            ">00 >65 wait >91 <health:0 >60 wait >00 >65 wait >60 wait >00 >65 wait >60 wait >00 "
            ">65 !stalled =answered:0");
  EXPECT_FALSE(bench.talk.is_scanning());
}

TEST_F(session_scanning, ContinuesIfItCannotBeStopped) {
  start();
  std::string script;
  for (int i = 0; i < 80; ++i) script += "+19 <packet ";
  const std::string went = bench.ask(requests::health(), script, while_scanning::stop_and_resume);
  EXPECT_NE(went.find("=still_scanning"), std::string::npos) << went;
  EXPECT_EQ(went.find("!"), std::string::npos) << went;
  EXPECT_TRUE(bench.talk.is_scanning());
}

TEST_F(session_scanning, StopsAnUnwantedScan) {
  EXPECT_PLAYED(bench, "<packet >00 >65 !found_scanning <packet wait");
  EXPECT_FALSE(bench.talk.is_busy());
  EXPECT_ASKED(bench, requests::health(), ">91 <health:0 =answered:0");
}

TEST_F(session_scanning, AcceptsARequestWhileItStopsAnUnwantedScan) {
  EXPECT_PLAYED(bench, "<packet >00 >65 !found_scanning <packet");
  EXPECT_ASKED(bench, requests::health(), "<packet wait >91 <health:0 =answered:0");
}

TEST_F(session_scanning, StopsAScanThatInterruptsAQuery) {
  EXPECT_ASKED(
      bench, requests::get_sample_rate(),
      ">D1 <packet >00 >65 !found_scanning wait >90 <byte:1 <info >D1 <byte:2 =answered:2");
}

TEST_F(session_scanning, QueryInterruptedRepeatedly_Ends) {
  EXPECT_EQ(
      bench.ask(requests::get_sample_rate(), "<packet wait <packet wait <packet wait <packet"),
      ">D1 <packet >00 >65 !found_scanning wait >90 <packet >00 >65 wait >90 <packet >00 >65 "
      "wait >90 <packet =still_scanning");
}

// ---- protection --------------------------------------------------------------------------------
TEST_F(session_scanning, UnknownProtection_GetsNoKeepAlive) {
  start();
  EXPECT_EQ(packets(100), "");
}

TEST_F(session_scanning, Protection_GetsAKeepAliveEverySecond) {
  protect();
  start();
  const std::string went = packets(105);
  std::size_t fed = 0;
  for (std::size_t at = 0; (at = went.find(">60", at)) != std::string::npos; ++at) ++fed;
  EXPECT_EQ(fed, 10U) << went;
  EXPECT_EQ(went.find("!"), std::string::npos) << went;
}

TEST_F(session_scanning, LateKeepAlive_IsReportedAndStartsAgain) {
  protect();
  start();
  EXPECT_PLAYED(bench, "late >60 !protection_starved <header <packet");
  EXPECT_TRUE(bench.talk.is_scanning());
}

TEST_F(session_scanning, DetectsThatTheProtectionIsOn) {
  start();
  EXPECT_EQ(packets(29), "");  // 3 s after the start the device stops
  EXPECT_PLAYED(bench, "wait >00 >65 !protection_found_on wait >60 <header <packet");
  EXPECT_EQ(bench.talk.protection(), power_down_protection::on);
  EXPECT_NE(packets(15).find(">60"), std::string::npos);
}

// ---- scans that end by themselves --------------------------------------------------------------
TEST_F(session_scanning, Silence_StartsTheScanAgain) {
  start();
  EXPECT_EQ(packets(70), "");
  EXPECT_PLAYED(bench, "wait >00 >65 !restarted wait >60 <header <packet");
  EXPECT_TRUE(bench.talk.is_scanning());
}

TEST_F(session_scanning, ScansThatAlwaysEndEarly_AreGivenUp) {
  start();
  for (int i = 0; i < 3; ++i) {
    EXPECT_PLAYED(bench, "<packet wait >00 >65 !restarted wait >60 <header");
  }
  EXPECT_PLAYED(bench, "<packet wait >00 >65 !stalled wait +60000");
  EXPECT_FALSE(bench.talk.is_scanning());
}

TEST_F(session_scanning, LongScans_AreRestartedWithoutLimit) {
  start();
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(packets(62), "");
    EXPECT_PLAYED(bench, "wait >00 >65 !restarted wait >60 <header");
  }
}

TEST_F(session_scanning, HeaderWithoutPackets_IsGivenUp) {  // insufficient power for the motor
  EXPECT_ASKED(bench, requests::start(), ">60 <header =answered");
  EXPECT_PLAYED(bench, "+9900 !spinning_up");
  EXPECT_PLAYED(bench,
                "wait >00 >65 !restarted wait >60 wait >00 >65 wait >60 wait >00 >65 wait "
                ">60 wait >00 >65 !stalled");
}

TEST_F(session_scanning, SpinUp_SendsNothing) {
  for (const std::string silence : {"+1500", "+2500", "+9000"}) {
    SCOPED_TRACE(silence);
    EXPECT_ASKED(bench, requests::start(), ">60 <header =answered");
    EXPECT_PLAYED(bench, silence + " !spinning_up <packet");
    EXPECT_EQ(packets(100), "");
    EXPECT_ASKED(bench, requests::stop(), ">00 >65 wait =answered");
  }
}

TEST_F(session_scanning, SpinUpWithProtection_SendsOnlyKeepAlives) {
  protect();
  EXPECT_ASKED(bench, requests::start(), ">60 <header =answered");
  EXPECT_PLAYED(bench, "+600 !spinning_up +600 >60 +1000 >60 +1000 >60 <packet");
}

TEST_F(session_scanning, SilenceAfterTheFirstPacket_IsNotSpinUp) {
  start();
  EXPECT_PLAYED(bench, "wait >00 >65 !restarted");
}

TEST_F(session_scanning, HeaderWithoutPackets_IsTriedTwice) {
  EXPECT_ASKED(bench, requests::start(), ">60 <header =answered");
  EXPECT_PLAYED(bench, "+9990 !spinning_up wait >00 >65 !restarted wait >60 <header");
  EXPECT_PLAYED(bench, "+900 !spinning_up +200 >60 +1000 >60");  // the protection may be on
  EXPECT_PLAYED(bench,
                "+7880 >60 >60 >60 >60 >60 >60 >60 wait >60 wait >00 >65 !stalled wait +60000");
  EXPECT_FALSE(bench.talk.is_scanning());
}

TEST_F(session_scanning, Reset_BeginsAgain) {
  protect();
  start();
  bench.talk.reset();
  EXPECT_FALSE(bench.talk.is_scanning());
  EXPECT_EQ(bench.talk.protection(), std::nullopt);
  EXPECT_ASKED(bench, requests::stop(), ">00 >65 <packet !found_scanning wait =answered");
}

TEST_F(session_scanning, AcceptsRequestsDuringARestart) {
  start();
  EXPECT_PLAYED(bench, "wait >00 >65 !restarted");
  EXPECT_ASKED(bench, requests::start(), "wait >60 <header =answered");
  EXPECT_PLAYED(bench, "<packet wait >00 >65 !restarted wait >60");
  EXPECT_ASKED(bench, requests::stop(), ">00 >65 <header wait =answered");
  EXPECT_FALSE(bench.talk.is_scanning());
}

}  // namespace
}  // namespace g4lidar::test
