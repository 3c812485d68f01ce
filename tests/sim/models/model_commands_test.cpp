// SPDX-License-Identifier: MIT
// Which commands each model has, and its answers. The expected values are from the table of the family, and
// not from that of the simulator.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "family_stream.hpp"

namespace g4lidar {
namespace {

using test::byte_vector;
using test::ms;
using test::second;
using ::testing::ElementsAreArray;
using ::testing::IsEmpty;

using codes = std::set<unsigned>;

codes operator+(codes one, const codes& other) {
  one.insert(other.begin(), other.end());
  return one;
}

const codes all_two_way{0x00, 0x40, 0x60, 0x65, 0x80, 0x90, 0x91, 0x92};
const codes stepped{0x09, 0x0A, 0x0B, 0x0C, 0x0D};
const codes motor{0x06, 0x07, 0x08, 0x0E, 0x0F};
const codes g4_codes = all_two_way + stepped + motor + codes{0x01, 0x02, 0x05, 0xD0, 0xD1, 0xD9};

const std::map<std::string, codes> expected{
    {"g4", g4_codes},
    {"g4-pro", g4_codes},
    {"g5", all_two_way + stepped + codes{0xD0, 0xD1}},
    {"f4", all_two_way + stepped},
    {"f4-pro", all_two_way + stepped + motor + codes{0x01, 0x02, 0xD0, 0xD1, 0xD9}},
    {"g1", all_two_way + stepped + codes{0x93}},
    {"g2", all_two_way + stepped + codes{0x93}},
    {"g2a", all_two_way + stepped + codes{0x93}},
    {"g2c", all_two_way + stepped + codes{0x93}},
    {"g4c", all_two_way + stepped},
    {"g4b", all_two_way + stepped},
    {"r2", all_two_way + stepped + codes{0x93}},
    {"g6", all_two_way + stepped + codes{0xD0, 0xD1, 0xD9}},
    {"g7", all_two_way + stepped + codes{0xD0, 0xD1, 0xD9}},
    {"x4", all_two_way},
    {"s4", all_two_way},
    {"s4b", all_two_way},
    {"t-mini", all_two_way + stepped},
    {"t-mini-pro", all_two_way + stepped},
    {"t-mini-plus", all_two_way + stepped},
    {"t-mini-plus-sh", all_two_way + stepped + codes{0x98}},
    {"tg15", all_two_way + stepped + codes{0x93, 0xD9}},  // D1: by the SDK only
    {"tg30", all_two_way + stepped + codes{0x93, 0xD9}},
    {"tg50", all_two_way + stepped + codes{0x93, 0xD9}},
};

// What a device has not, it neither obeys nor answers; the log shows it.
TEST(SimModelCommands, EachModelHasItsOwn) {
  for (const test::family_model& each : test::family_models) {
    if (!each.answers) continue;
    for (unsigned code = 0; code < 256; ++code) {
      if (code == 0xA5) continue;  // begins a command
      test::host_side host(test::options_of(each.word));
      const byte_vector answer = host.ask(static_cast<std::uint8_t>(code), 20 * ms);
      const bool has = expected.at(each.word).count(code) != 0;
      ASSERT_EQ(host.device.log().size(), 1U);
      EXPECT_EQ(host.device.log().front().obeyed, has) << each.word << ", " << std::hex << code;
      const bool is_silent = code == 0x00 || code == 0x40 || code == 0x65 || code == 0x80;
      EXPECT_EQ(!answer.empty(), has && !is_silent) << each.word << ", " << std::hex << code;
    }
  }
}

byte_vector four_bytes(std::int32_t number, unsigned type = 0x04) {
  const auto bits = static_cast<std::uint32_t>(number);
  byte_vector made{0xA5, 0x5A, 0x04, 0, 0, 0, static_cast<std::uint8_t>(type)};
  for (int i = 0; i < 32; i += 8) made.push_back(static_cast<std::uint8_t>(bits >> i & 0xFFU));
  return made;
}

// Of 5.0 to 12.0 Hz, of a T-mini 6.0, of a TG 3.0 to 16.0; a TG answers 0.4 Hz more.
TEST(SimModelCommands, TheFrequencyHasTheStepsAndLimitsOfTheModel) {
  struct row {
    std::string word;
    int first_chz, least_chz, most_chz, more_chz;
  };
  for (const row& each :
       {row{"g4", 700, 500, 1200, 0}, row{"g6", 700, 500, 1200, 0}, row{"r2", 700, 500, 1200, 0},
        row{"t-mini-pro", 1000, 600, 1200, 0}, row{"t-mini-plus-sh", 1000, 600, 1200, 0},
        row{"tg15", 700, 300, 1600, 40}, row{"tg50", 700, 300, 1600, 40}}) {
    SCOPED_TRACE(each.word);
    test::host_side host(test::options_of(each.word));
    const auto reports = [&](std::uint8_t code, int chz) {
      EXPECT_EQ(host.ask(code), four_bytes(chz + each.more_chz)) << std::hex << unsigned{code};
    };
    reports(0x0D, each.first_chz);
    reports(0x09, each.first_chz + 10);
    reports(0x0A, each.first_chz);
    reports(0x0B, each.first_chz + 100);
    reports(0x0C, each.first_chz);
    for (int i = 0; i < 15; ++i) (void)host.ask(0x0B);
    reports(0x0D, each.most_chz);
    for (int i = 0; i < 15; ++i) (void)host.ask(0x0C);
    reports(0x0D, each.least_chz);
    EXPECT_EQ(host.device.settings().scan_frequency_chz, each.least_chz);
  }
}

TEST(SimModelCommands, RatesAreSteppedInTheOrderOfTheirCodes) {
  const auto steps = [](const std::string& word) {
    test::host_side host(test::options_of(word));
    std::vector<int> found{host.ask(0xD1).back()};
    for (int i = 0; i < 4; ++i) found.push_back(host.ask(0xD0).back());
    return found;
  };
  EXPECT_EQ(steps("g4"), (std::vector{2, 0, 1, 2, 0}));
  EXPECT_EQ(steps("g6"), (std::vector{2, 0, 1, 2, 0}));
  EXPECT_EQ(steps("f4-pro"), (std::vector{0, 1, 0, 1, 0}));
}

// Samples between two revolutions: those of 8 kHz are twice those of 4 kHz.
TEST(SimModelCommands, ARateIsThatOfTheModel) {
  const auto samples_per_s = [](const std::string& word, int steps) {
    test::host_side host(test::options_of(word));
    for (int i = 0; i < steps; ++i) (void)host.ask(0xD0);
    (void)host.ask(command::start, second);
    std::vector<sim::sent_sample> truth(200'000);
    (void)host.device.take_truth(truth);
    (void)host.listen(second);
    return static_cast<double>(host.device.take_truth(truth));
  };
  EXPECT_NEAR(samples_per_s("f4-pro", 0), 4000, 100);
  EXPECT_NEAR(samples_per_s("f4-pro", 1), 6000, 100);
  EXPECT_NEAR(samples_per_s("g6", 0), 18'000, 200);
  EXPECT_NEAR(samples_per_s("g6", 1), 8000, 200);
  EXPECT_NEAR(samples_per_s("g7", 2), 16'000, 200);
}

TEST(SimModelCommands, WhetherATgAnswersD1_IsAnOption) {
  sim::device_options options = test::options_of("tg30");
  test::host_side silent(options);
  EXPECT_THAT(silent.ask(0xD1, 500 * ms), IsEmpty());
  options.answers_sample_rate = true;
  test::host_side other(options);
  EXPECT_THAT(other.ask(0xD1), ElementsAreArray({0xA5, 0x5A, 0x01, 0, 0, 0, 0x04, 0x02}));
}

// The manufacturer's program knows 3 for 20 kHz and 4 for 10 kHz.
TEST(SimModelCommands, OtherCodesOfTheRatesOfATg) {
  for (const auto& [hz, code] : {std::pair{20'000, 3}, {18'000, 1}, {10'000, 4}}) {
    sim::device_options options = test::options_of("tg30");
    options.answers_sample_rate = options.other_rate_codes = true;
    options.scanner.sample_rate = static_cast<sample_rate>(hz);
    test::host_side host(options);
    EXPECT_THAT(host.ask(0xD1), ElementsAreArray({0xA5, 0x5A, 0x01, 0, 0, 0, 0x04, code})) << hz;
  }
}

// 180.5 degrees in quarters, and of an R2 from firmware 1.8 on in hundredths.
TEST(SimModelCommands, TheZeroAngleIsInPartsOfADegree) {
  const auto answer = [](const std::string& word, int major, int minor, std::int32_t cdeg) {
    sim::device_options options;
    options.info.firmware_major = static_cast<std::uint8_t>(major);
    options.info.firmware_minor = static_cast<std::uint8_t>(minor);
    EXPECT_TRUE(sim::use_model(options, word));
    options.zero_angle_cdeg = cdeg;
    test::host_side host(options);
    return host.ask(0x93);
  };
  EXPECT_EQ(answer("g2", 3, 5, 18'050), four_bytes(722));
  EXPECT_EQ(answer("tg15", 1, 8, 10'805), four_bytes(432));
  EXPECT_EQ(answer("tg15", 1, 2, -1000), four_bytes(-40));
  EXPECT_EQ(answer("r2", 1, 8, 722), four_bytes(722));
  EXPECT_EQ(answer("r2", 1, 7, 18'050), four_bytes(722));
  EXPECT_EQ(answer("r2", 1, 8, -722), four_bytes(-722));
  EXPECT_EQ(answer("g1", 3, 2, 0), four_bytes(0));
}

// The angles on the wire are smaller by it: those of the zero packets, where a revolution begins.
TEST(SimModelCommands, TheZeroAngleIsMissingInTheAngles) {
  for (const std::int32_t cdeg : {0, 3000, -3000}) {
    sim::device_options options = test::options_of("tg15");
    options.zero_angle_cdeg = cdeg;
    std::vector<double> begins;
    test::for_each_packet(test::stream_of(options, 3 * second).bytes, model_named("tg15")->samples,
                          [&](packet_view packet, std::size_t) {
                            const unsigned word = packet.data()[4] + 256U * packet.data()[5];
                            if (packet.is_zero()) begins.push_back((word >> 1U) / 64.0);
                          });
    ASSERT_GT(begins.size(), 5U);
    for (const double begin : begins) EXPECT_NEAR(begin, 108.0 - cdeg / 100.0, 0.3);
  }
}

TEST(SimModelCommands, TheTiltOfATMiniPlusSh) {
  sim::device_options options = test::options_of("t-mini-plus-sh");
  options.pitch_cdeg = -123;
  test::host_side host(options);
  EXPECT_EQ(host.ask(0x98), four_bytes(-123, 0x10));
}

// From logs of users: an X4, a G2, a T-mini Plus, a lidar of the class of the X2.
TEST(SimModelCommands, TheIdentityIsThatOfTheModel) {
  const std::map<std::string, std::array<int, 4>> known{// id, minor, major, hardware
                                                        {"x4", {6, 10, 1, 1}},
                                                        {"g2", {15, 5, 3, 3}},
                                                        {"t-mini-plus", {151, 3, 1, 1}},
                                                        {"g4", {5, 2, 3, 3}},
                                                        {"tg30", {101, 2, 3, 3}}};
  for (const auto& [word, four] : known) {
    test::host_side host(test::options_of(word));
    const byte_vector answer = host.ask(0x90);
    ASSERT_EQ(answer.size(), 27U) << word;
    EXPECT_TRUE(std::equal(four.begin(), four.end(), answer.begin() + 7)) << word;
  }
  sim::device_options options;
  options.info.firmware_major = 1;
  options.info.firmware_minor = 5;
  ASSERT_TRUE(sim::use_model(options, "x4-pro"));
  EXPECT_EQ(options.info.firmware_minor, 5) << "one that was given is kept";
  ASSERT_TRUE(sim::use_model(options, "g4"));
  EXPECT_EQ(options.info.firmware_minor, 5);
}

}  // namespace
}  // namespace g4lidar
