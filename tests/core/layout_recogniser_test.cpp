// SPDX-License-Identifier: MIT
#include "g4lidar/core/layout_recogniser.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <tuple>

#include "sampled_room.hpp"
#include "support/family_reference.hpp"

namespace g4lidar {
namespace {

using test::basis_of;
using test::byte_vector;
using test::information;
using test::recognised;
using test::room;

/// `A5 5A`, length 20, type 4: a device information.
byte_vector information_of(unsigned id) {
  byte_vector made{0xA5, 0x5A, 0x14, 0, 0, 0, 0x04, static_cast<std::uint8_t>(id), 1, 3, 1};
  for (unsigned i = 0; i < 16; ++i) made.push_back(static_cast<std::uint8_t>(i % 10));
  return made;
}

struct sample_case {
  std::string sent;
  std::size_t bytes;
  std::string usual;
};

class UsualModel : public ::testing::TestWithParam<sample_case> {};

TEST_P(UsualModel, FollowsFromTheSizeOfASample) {
  const auto& [sent, size, usual] = GetParam();
  for (const std::size_t piece : {1U, 7U, 64U, 4096U}) {
    const byte_vector all = room(sent).of(3);
    EXPECT_EQ(recognised(all, piece).word, usual) << piece;
  }
  layout_recogniser seen;
  const byte_vector all = room(sent).of(1);
  std::size_t taken = 0;
  while (seen.sample_bytes() == 0 && taken < all.size()) seen.take(bytes(all).subspan(taken++, 1));
  EXPECT_EQ(seen.sample_bytes(), size);
  // Three packets that another one follows: the fourth is complete by then, or the fifth.
  EXPECT_LT(taken, 10 + size + 4 * (10 + 40 * size) + 1);
}

INSTANTIATE_TEST_SUITE_P(Layouts, UsualModel,
                         ::testing::Values(sample_case{"g4", 2, "g4"}, sample_case{"x4", 2, "g4"},
                                           sample_case{"g6", 2, "g4"}, sample_case{"tg15", 2, "g4"},
                                           sample_case{"g2", 3, "t-mini-pro"},
                                           sample_case{"s4b", 3, "t-mini-pro"},
                                           sample_case{"scl", 3, "t-mini-pro"},
                                           sample_case{"t-mini", 3, "t-mini-pro"},
                                           sample_case{"t-mini-plus-sh", 4, "t-mini-plus-sh"}),
                         [](const auto& each) {
                           std::string name = each.param.sent;
                           std::erase(name, '-');
                           return name;
                         });

TEST(LayoutRecogniser, IsUndecidedWithoutALeadOfThree) {
  const byte_vector all = room("t-mini").of(1);
  const std::size_t first = 13;          // the zero packet
  const std::size_t next = 10 + 40 * 3;  // each of the others
  layout_recogniser seen;
  EXPECT_EQ(seen.sample_bytes(), 0U);
  EXPECT_EQ(seen.most_likely().word, "g4");
  seen.take(bytes(all).first(first + 2 * next));  // two are followed
  EXPECT_EQ(seen.sample_bytes(), 0U);
  layout_recogniser same = seen;
  seen.take(bytes(all).subspan(first + 2 * next, next));
  EXPECT_EQ(seen.sample_bytes(), 3U);
  same.finish();  // the third one is at the end
  EXPECT_EQ(same.sample_bytes(), 3U);
}

/// The bytes of the zero packet and of the packets behind it that one or two whole packets leave.
byte_vector first_packets(std::string_view model, unsigned from, unsigned count) {
  const byte_vector all = room(model).of(1);
  const auto size = static_cast<unsigned>(reference::wire_format_of(model).sample_bytes);
  const auto at = [size](unsigned packet) {
    return packet == 0 ? 0 : 10 + size + (packet - 1) * (10 + 40 * size);
  };
  return {all.begin() + static_cast<std::ptrdiff_t>(at(from)),
          all.begin() + static_cast<std::ptrdiff_t>(at(from + count))};
}

TEST(LayoutRecogniser, AtTheEnd_TheBestSizeDecides) {
  for (const reference::wire_format& how : reference::wire_formats) {
    for (const unsigned count : {1U, 2U, 3U}) {
      for (const int cut : {0, 1, 17}) {  // bytes of the next packet
        SCOPED_TRACE(how.model + " " + std::to_string(count) + " " + std::to_string(cut));
        byte_vector all = first_packets(how.model, 1, count);
        const byte_vector next = first_packets(how.model, 1 + count, 1);
        all.insert(all.end(), next.begin(), next.begin() + cut);
        layout_recogniser seen;
        seen.take(all);
        EXPECT_EQ(seen.sample_bytes(), 0U) << "there is no lead of three yet";
        seen.finish();
        EXPECT_EQ(seen.sample_bytes(), static_cast<std::size_t>(how.sample_bytes));
        EXPECT_EQ(seen.basis(), recognised_by::size);
        EXPECT_EQ(sample_size(seen.most_likely().samples.layout),
                  static_cast<std::size_t>(how.sample_bytes));
        all.insert(all.begin(), {0x13, 0xAA, 0x55});
        EXPECT_EQ(basis_of(all), recognised_by::size) << "noise before it";
      }
    }
  }
}

TEST(LayoutRecogniser, AtTheEnd_OnePacketAndANumberNameTheModel) {
  for (const auto& [sent, id, word] : {std::tuple{"tg15", 101U, "tg30"},
                                       {"t-mini", 151U, "t-mini-plus"},
                                       {"g2", 15U, "g2"},
                                       {"t-mini-plus-sh", 152U, "t-mini-plus-sh"}}) {
    byte_vector all = information_of(id);
    const byte_vector packet = first_packets(sent, 1, 1);
    all.insert(all.end(), packet.begin(), packet.end());
    EXPECT_EQ(recognised(all).word, word);
    EXPECT_EQ(basis_of(all), recognised_by::number) << word;
  }
}

TEST(LayoutRecogniser, DamagedPacketsDoNotDecide) {
  byte_vector all = room("t-mini").of(20);
  for (std::size_t i = 50; i < all.size(); i += 300) all[i] ^= 0x10U;  // in half of the packets
  EXPECT_EQ(recognised(all).word, "t-mini-pro");
  byte_vector noise(100'000);
  std::uint32_t state = 1;
  for (auto& byte : noise) {
    state = state * 1'664'525U + 1'013'904'223U;
    byte = static_cast<std::uint8_t>(state >> 24U);
  }
  layout_recogniser seen;
  seen.take(noise);
  seen.finish();
  EXPECT_EQ(seen.sample_bytes(), 0U);
}

// The XOR of a whole packet with its checksum is 0, so a size that also takes the next one fits again.
TEST(LayoutRecogniser, NothingButZeros) {
  const auto& how = reference::wire_format_of("t-mini");
  byte_vector all;
  for (unsigned i = 0; i < 200; ++i) {
    const byte_vector packet =
        reference::packet_of(how, 0, 400, 800, std::vector<reference::wire_sample>(40));
    all.insert(all.end(), packet.begin(), packet.end());
  }
  layout_recogniser seen;
  seen.take(all);
  EXPECT_EQ(seen.sample_bytes(), 3U);
}

TEST(LayoutRecogniser, ADeviceInformationNamesTheModel) {
  const auto with = [](std::string_view sent, unsigned id) {
    room with_reply(sent);
    with_reply.reply = information_of(id);
    return std::string(recognised(with_reply.of(3)).word);
  };
  EXPECT_EQ(with("g4", 5), "g4");
  EXPECT_EQ(with("x4", 6), "x4");
  EXPECT_EQ(with("g6", 13), "g6");
  EXPECT_EQ(with("tg15", 101), "tg30");
  EXPECT_EQ(with("g2", 15), "g2");
  EXPECT_EQ(with("scl", 22), "scl");
  EXPECT_EQ(with("t-mini", 151), "t-mini-plus");
  EXPECT_EQ(with("x4", 150), "g4");  // its samples have another size
}

TEST(LayoutRecogniser, OfSeveralModelsTheSampleRateDecides) {
  const auto at = [](unsigned samples, unsigned dhz) {
    room announced("x4");
    announced.reply = information_of(4);
    announced.samples = samples;
    announced.stated.dhz = dhz;
    return std::string(recognised(announced.of(4)).word);
  };
  EXPECT_EQ(at(714, 70), "x4-pro");  // 4998 per second
  EXPECT_EQ(at(428, 70), "x2");      // 2996
  EXPECT_EQ(at(714, 0), "x2");       // the frequency is not reported
}

/// A number that contradicts the samples states that the usual model is not certain: then the sample rate decides.
TEST(LayoutRecogniser, ANumberOfAnotherSize_LetsTheSampleRateDecide) {
  const auto at = [](unsigned samples, unsigned dhz, unsigned id) {
    room announced("t-mini");
    if (id != 0) announced.reply = information_of(id);
    announced.samples = samples;
    announced.stated.dhz = dhz;
    return std::string(recognised(announced.of(4)).word);
  };
  EXPECT_EQ(at(714, 70, 5), "g2");            // 4998 per second, and the number of a G4
  EXPECT_EQ(at(571, 70, 5), "t-mini-pro");    // 3997
  EXPECT_EQ(at(714, 70, 0), "t-mini-pro");    // nothing contradicts the usual model
  EXPECT_EQ(at(714, 0, 5), "t-mini-pro");     // the rate is not stated
  EXPECT_EQ(at(2000, 120, 5), "t-mini-pro");  // 24,000: no model
}

TEST(LayoutRecogniser, InformationInCt_OfARevolutionWhoseCrcFits) {
  room informed("x4");
  informed.stated = {4, 70};
  informed.samples = 714;
  EXPECT_EQ(recognised(informed.of(2)).word, "x4-pro");
  informed.stated.has_crc = false;
  EXPECT_EQ(recognised(informed.of(20)).word, "g4");
  // The lower half of 100 is 4, too: a TG15, whose ranges use the second bit.
  room whole("tg15");
  whole.stated = {100, 70};
  EXPECT_EQ(recognised(whole.of(20)).word, "g4");
}

TEST(LayoutRecogniser, StatesWhatTheModelFollowsFrom) {
  const auto after = [](unsigned id) {
    room with_reply("x4");
    with_reply.reply = information_of(id);
    return basis_of(with_reply.of(3));
  };
  EXPECT_EQ(basis_of({}), recognised_by::nothing);
  EXPECT_EQ(basis_of(room("x4").of(3)), recognised_by::size);
  EXPECT_EQ(basis_of(room("t-mini").of(3)), recognised_by::size);
  EXPECT_EQ(after(6), recognised_by::number);
  EXPECT_EQ(after(200), recognised_by::size);  // of no model
  EXPECT_EQ(after(150), recognised_by::size);  // of a model with another size
  room flagged("x4");
  flagged.has_flags_alone = true;
  EXPECT_EQ(basis_of(flagged.of(4)), recognised_by::flags);
  room informed("x4");
  informed.stated = {4, 70};
  EXPECT_EQ(basis_of(informed.of(2)), recognised_by::size) << "X2, X3, S2, X4 Pro and others";
  room single("s4b");
  single.stated = {11, 53};
  EXPECT_EQ(recognised(single.of(2)).word, "s4b");
  EXPECT_EQ(basis_of(single.of(2)), recognised_by::number) << "no other model has it";
  single.stated.has_crc = false;
  EXPECT_EQ(basis_of(single.of(2)), recognised_by::size);
}

/// From 4 to 12 Hz a revolution has 1 + rate / frequency / 40 packets: at 3 kHz 20 to 8, at 5 kHz 33 to 12.
TEST(LayoutRecogniser, NumberInCt_AtEachRateAndFrequency) {
  struct sender {
    std::string_view layout;
    unsigned id;
    unsigned rate_hz;
    sample_layout wanted;
    correction_kind correction;
  };
  using enum sample_layout;
  using enum correction_kind;
  for (const auto& [layout, id, rate_hz, wanted, correction] :
       {sender{"x4", 4, 3000, flagged_mm, triangle}, sender{"x4", 6, 3000, flagged_mm, triangle},
        sender{"x4", 12, 4000, flagged_mm, triangle}, sender{"x4", 4, 5000, flagged_mm, triangle},
        sender{"s4b", 4, 3000, intensity_8, triangle},
        sender{"s4b", 12, 3000, intensity_8, triangle},
        sender{"s4b", 11, 4000, intensity_8, triangle},
        sender{"scl", 22, 3000, intensity_8, scl}}) {
    for (unsigned dhz = 40; dhz <= 120; dhz += 5) {
      room informed(layout);
      informed.stated = {id, dhz};
      informed.samples = 10 * rate_hz / dhz;
      const unsigned packets = 1 + (informed.samples + 38) / 40;
      const model& found = recognised(informed.of(5));
      const bool has_number = packets > 7;
      EXPECT_EQ(found.samples.layout == wanted && found.samples.correction == correction,
                has_number)
          << layout << " " << id << " " << rate_hz << " Hz at " << dhz << ": " << found.word;
    }
  }
}

TEST(LayoutRecogniser, ThreeBytesOfAnS2) {
  room informed("s4b");
  informed.stated = {4, 53};  // 561 samples a revolution: 2973 per second
  EXPECT_EQ(recognised(informed.of(2)).word, "s2-intensity");
}

TEST(LayoutRecogniser, HasAPacketWhenTheFirstIsComplete) {
  const byte_vector all = room("g4").of(1);
  layout_recogniser seen;
  seen.take(bytes(all).first(11));
  EXPECT_FALSE(seen.has_packet());
  seen.take(bytes(all).subspan(11, 1));
  EXPECT_TRUE(seen.has_packet());
}

TEST(LayoutRecogniser, SamplesOfFlagsAlone) {
  room flagged("x4");
  flagged.has_flags_alone = true;
  EXPECT_EQ(recognised(flagged.of(4)).word, "x2");
  room whole("tg15");  // no range is so short, but the second bit is set in half of them
  whole.has_flags_alone = true;
  EXPECT_EQ(recognised(whole.of(4)).word, "g4");
}

}  // namespace
}  // namespace g4lidar
