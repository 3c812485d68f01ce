// SPDX-License-Identifier: MIT
// Sessions with models other than the G4: what is refused, offsets, rates, angles.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "g4lidar/core/session.hpp"

namespace g4lidar {
namespace {

constexpr std::int64_t ms = 1'000'000;

/// The answers to what clears a link: 90, 91 and 92. Empty for other commands.
std::vector<std::uint8_t> known_answer(std::uint8_t code) {
  std::vector<std::uint8_t> reply{0xA5, 0x5A, 0x14, 0, 0, 0, 4, 1, 1, 1, 1};
  if (code == 0x90) reply.resize(27, 0);
  if (code == 0x91 || code == 0x92) reply = {0xA5, 0x5A, 3, 0, 0, 0, 6, 0, 0, 0};
  return code >= 0x90 && code <= 0x92 ? reply : std::vector<std::uint8_t>();
}

/// A device that answers each command with fixed bytes.
struct scripted {
  explicit scripted(std::string_view word)
      : which(*model_named(word)), parser(which.samples), talk(session_times(), which) {}

  /// The outcome of `wanted`. `answers` are the bytes behind the seven of the header, for each command of
  /// the code `code` in turn; the last one is repeated.
  outcome ask(const request& wanted, std::uint8_t code,
              std::vector<std::vector<std::uint8_t>> answers, std::uint8_t type = 4) {
    EXPECT_FALSE(talk.begin(wanted, now_ns));
    for (int i = 0; i < 200; ++i) {
      while (const auto sent = talk.to_send()) {
        const auto known = known_answer((*sent)[1]);
        parser.feed(known, [&](const event& found) { talk.take(found, now_ns); });
        if ((*sent)[1] != code || answers.empty()) continue;
        std::vector<std::uint8_t> reply{
            0xA5, 0x5A, static_cast<std::uint8_t>(answers.front().size()), 0, 0, 0, type};
        reply.insert(reply.end(), answers.front().begin(), answers.front().end());
        if (answers.size() > 1) answers.erase(answers.begin());
        parser.feed(reply, [&](const event& found) { talk.take(found, now_ns); });
      }
      if (const auto done = talk.finished()) return *done;
      now_ns = std::max(now_ns + ms, std::min(talk.next_look_ns(), now_ns + 1000 * ms));
      talk.look(now_ns);
    }
    ADD_FAILURE() << "no end";
    return {wanted};
  }

  const model& which;
  stream_parser parser;
  session talk;
  std::int64_t now_ns = 0;
};

TEST(ModelSession, RequestsThatTheModelDoesNotHave_AreRefusedBeforeSending) {
  struct refused {
    std::string_view word;
    request wanted;
  };
  for (const auto& [word, wanted] :
       std::initializer_list<refused>{{"x4", requests::get_scan_frequency()},
                                      {"x4", requests::set(scan_frequency{700})},
                                      {"x4", requests::get_sample_rate()},
                                      {"x4", requests::set(power_down_protection::on)},
                                      {"g1", requests::set(sample_rate{9000})},
                                      {"g1", requests::get_direction()},
                                      {"tg15", requests::set(sample_rate{20'000})},
                                      {"g4", requests::zero_angle()},
                                      {"g4", requests::pitch()},
                                      {"t-mini", requests::pitch()},
                                      {"x2", requests::device_info()}}) {
    session talk(session_times(), *model_named(word));
    EXPECT_EQ(talk.begin(wanted, 0), refusal::not_supported) << word;
    EXPECT_FALSE(talk.to_send()) << word;
    EXPECT_FALSE(talk.is_busy()) << word;
  }
}

TEST(ModelSession, ValuesOfAnotherModel_AreRefused) {
  struct refused {
    std::string_view word;
    request wanted;
  };
  for (const auto& [word, wanted] :
       std::initializer_list<refused>{{"g6", requests::set(sample_rate{9000})},
                                      {"g4", requests::set(sample_rate{18'000})},
                                      {"f4-pro", requests::set(sample_rate{8000})},
                                      {"t-mini", requests::set(scan_frequency{599})},
                                      {"tg15", requests::set(scan_frequency{1601})},
                                      {"tg15", requests::set(scan_frequency{299})}}) {
    session talk(session_times(), *model_named(word));
    EXPECT_EQ(talk.begin(wanted, 0), refusal::bad_setting) << word;
  }
}

// family: 18 kHz is the third rate of a G6, code 2.
TEST(ModelSession, RatesAreThoseOfTheModel) {
  scripted g6("g6");
  const outcome asked = g6.ask(requests::get_sample_rate(), 0xD1, {{2}});
  EXPECT_EQ(std::get<sample_rate>(asked.value), sample_rate{18'000});
  scripted tg("tg15");
  EXPECT_EQ(std::get<sample_rate>(tg.ask(requests::get_sample_rate(), 0xD1, {{1}}).value),
            sample_rate{18'000});
  scripted f4("f4-pro");
  EXPECT_EQ(std::get<sample_rate>(f4.ask(requests::get_sample_rate(), 0xD1, {{1}}).value),
            sample_rate{6000});
}

// After the last of two rates comes the first: an F4 Pro at 6 kHz is at 4 kHz after one D0.
TEST(ModelSession, StepsThroughTwoRates) {
  scripted f4("f4-pro");
  ASSERT_FALSE(f4.talk.begin(requests::set(sample_rate{4000}), 0));
  std::uint8_t code = 1;
  std::optional<outcome> done;
  for (int i = 0; i < 100 && !done; ++i) {
    while (const auto sent = f4.talk.to_send()) {
      const std::uint8_t command = (*sent)[1];
      if (command == 0xD0) code = code == 0 ? 1 : 0;
      const auto known = known_answer(command);
      f4.parser.feed(known, [&](const event& found) { f4.talk.take(found, f4.now_ns); });
      if (command != 0xD0 && command != 0xD1) continue;
      const std::array<std::uint8_t, 8> reply{0xA5, 0x5A, 1, 0, 0, 0, 4, code};
      f4.parser.feed(reply, [&](const event& found) { f4.talk.take(found, f4.now_ns); });
    }
    done = f4.talk.finished();
    f4.talk.look(f4.now_ns += 10 * ms);
  }
  ASSERT_TRUE(done);
  EXPECT_EQ(done->how, verdict::answered);
  EXPECT_EQ(code, 0);
}

// A TG answers 0.4 Hz too high.
TEST(ModelSession, FrequencyHasTheOffsetOfTheModel) {
  scripted tg("tg30");
  const outcome asked = tg.ask(requests::get_scan_frequency(), 0x0D, {{0xE4, 0x02, 0, 0}});
  EXPECT_EQ(std::get<scan_frequency>(asked.value).chz, 700) << "740 - 40";
}

// A TG may not know D1: one short wait, and the link is clear again.
TEST(ModelSession, RateOfATg_SurvivesSilence) {
  scripted tg("tg15");
  ASSERT_FALSE(tg.talk.begin(requests::get_sample_rate(), 0));
  int asked = 0;
  std::optional<outcome> done;
  for (int i = 0; i < 500 && !done; ++i) {
    while (const auto sent = tg.talk.to_send()) {
      if ((*sent)[1] == 0xD1) ++asked;
      const auto reply = known_answer((*sent)[1]);
      tg.parser.feed(reply, [&](const event& found) { tg.talk.take(found, tg.now_ns); });
    }
    done = tg.talk.finished();
    tg.talk.look(tg.now_ns += 10 * ms);
  }
  ASSERT_TRUE(done);
  EXPECT_EQ(done->how, verdict::timed_out);
  EXPECT_EQ(asked, 1);
  EXPECT_LT(tg.now_ns, 2'000 * ms);
}

std::vector<std::uint8_t> word_of(std::int32_t value) {
  const auto bits = static_cast<std::uint32_t>(value);
  std::vector<std::uint8_t> made;
  for (unsigned shift = 0; shift < 32; shift += 8) {
    made.push_back(static_cast<std::uint8_t>(bits >> shift));
  }
  return made;
}

// In 1/4 degrees, of a new R2 in 1/100 degrees.
TEST(ModelSession, ZeroAngle_HasTheUnitOfTheModel) {
  const auto zero_of = [](std::string_view word, std::int32_t value) {
    scripted device(word);
    return std::get<zero_angle>(device.ask(requests::zero_angle(), 0x93, {word_of(value)}).value);
  };
  EXPECT_EQ(zero_of("g2", 6).deg(), 1.5);
  EXPECT_EQ(zero_of("tg15", -433).deg(), -108.25);
  EXPECT_EQ(zero_of("r2", -150).deg(), -1.5);
  EXPECT_EQ(zero_of("r2", 36'000).deg(), 360.0);
  EXPECT_FALSE(zero_of("g1", 720).is_calibrated()) << "180 degrees";
  EXPECT_TRUE(zero_of("g1", 4).is_calibrated());
}

TEST(ModelSession, ZeroAngleBeyondATurn_IsAskedAgain) {
  scripted g2("g2");
  ASSERT_FALSE(g2.talk.begin(requests::zero_angle(), 0));
  int asked = 0;
  std::optional<outcome> done;
  for (int i = 0; i < 500 && !done; ++i) {
    while (const auto sent = g2.talk.to_send()) {
      std::vector<std::uint8_t> reply = known_answer((*sent)[1]);
      if ((*sent)[1] == 0x93) {
        reply = {0xA5, 0x5A, 4, 0, 0, 0, 4};
        const auto word = word_of(asked++ == 0 ? 1441 : 8);
        reply.insert(reply.end(), word.begin(), word.end());
      }
      g2.parser.feed(reply, [&](const event& found) { g2.talk.take(found, g2.now_ns); });
    }
    done = g2.talk.finished();
    g2.talk.look(g2.now_ns += 10 * ms);
  }
  ASSERT_TRUE(done);
  EXPECT_EQ(asked, 2);
  EXPECT_EQ(std::get<zero_angle>(done->value).deg(), 2.0);
}

TEST(ModelSession, Pitch_HasAnAnswerOfItsOwnType) {
  scripted sh("t-mini-plus-sh");
  const outcome done = sh.ask(requests::pitch(), 0x98, {word_of(-125)}, 0x10);
  EXPECT_EQ(std::get<pitch_angle>(done.value).deg(), -1.25);
}

// The parser of a G4 refuses what only an angle can be, as before.
TEST(ModelSession, AnglesAreNoAnswersOfAG4) {
  const std::array<std::uint8_t, 11> angle{0xA5, 0x5A, 4, 0, 0, 0, 4, 0x4F, 0xFE, 0xFF, 0xFF};
  const std::array<std::uint8_t, 11> pitch{0xA5, 0x5A, 4, 0, 0, 0, 0x10, 1, 0, 0, 0};
  EXPECT_FALSE(response_view::from(angle));
  EXPECT_FALSE(response_view::from(pitch));
  ASSERT_TRUE(response_view::from(angle, true));
  EXPECT_EQ(response_view::from(angle, true)->as_angle(), -433);
  EXPECT_FALSE(response_view::from(angle, true)->as_frequency_chz());
  ASSERT_TRUE(response_view::from(pitch, true));
  EXPECT_EQ(response_view::from(pitch, true)->kind(), response_kind::pitch);
}

}  // namespace
}  // namespace g4lidar
