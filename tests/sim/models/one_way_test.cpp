// SPDX-License-Identifier: MIT
// Models that send from power-on; the CRC byte; the information in CT; flags and intensity.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "family_stream.hpp"
#include "g4lidar/core/ct_information.hpp"
#include "support/crc_reference.hpp"

namespace g4lidar {
namespace {

using test::byte_vector;
using test::ms;
using test::second;
using ::testing::ElementsAre;

const sample_format& format_of(const std::string& word) { return model_named(word)->samples; }

std::size_t packets_in(const byte_vector& bytes, const std::string& word) {
  std::size_t packets = 0;
  test::for_each_packet(bytes, format_of(word), [&](packet_view, std::size_t) { ++packets; });
  return packets;
}

TEST(SimOneWay, SendsWithoutACommand_AndIgnoresAll) {
  for (const test::family_model& each : test::family_models) {
    SCOPED_TRACE(each.word);
    test::host_side host(test::options_of(each.word));
    EXPECT_EQ(host.device.is_scanning(), !each.answers);
    EXPECT_EQ(packets_in(host.listen(second), each.word) > 50, !each.answers);
    if (each.answers) continue;
    for (unsigned code = 0; code < 256; ++code) host.send(static_cast<std::uint8_t>(code));
    const byte_vector after = host.listen(second);
    EXPECT_TRUE(host.device.is_scanning());
    EXPECT_TRUE(host.device.log().empty()) << "a command was executed";
    EXPECT_GT(packets_in(after, each.word), 50U);
  }
}

// The device information, the scan header, packets while the motor starts.
TEST(SimOneWay, AfterPowerOn_ItIntroducesItself) {
  sim::device_options options = test::options_of("x2");
  options.boots_at_start = true;
  options.boot_text = false;
  test::host_side host(options);
  EXPECT_TRUE(host.listen(options.boot_ns - 10 * ms).empty());
  const byte_vector sent = host.listen(2 * second);
  stream_parser parser(format_of("x2"));
  std::vector<std::string> seen;
  parser.feed(sent, [&](const event& found) {
    if (const auto* const answer = std::get_if<response_view>(&found)) {
      const bool is_info = answer->kind() == response_kind::device_info;
      seen.emplace_back(is_info ? "information" : "header");
    } else if (std::holds_alternative<packet_view>(found) && seen.size() < 4) {
      seen.emplace_back("packet");
    }
  });
  EXPECT_THAT(seen, ElementsAre("information", "header", "packet", "packet"));
  ASSERT_GT(sent.size(), 8U);
  EXPECT_EQ(sent[7], 4) << "the number of an X2";
}

/// The CT bytes of each whole revolution, and the byte before the next one; none: -1.
struct revolution {
  std::vector<std::uint8_t> ct;
  int byte_behind;
};
std::vector<revolution> revolutions_of(const byte_vector& bytes, const std::string& word) {
  std::vector<revolution> all;
  std::uint8_t last_skipped = 0;
  std::size_t skipped_bytes = 0;
  stream_parser parser(format_of(word));
  parser.feed(bytes, [&](const event& found) {
    if (const auto* const gone = std::get_if<skipped>(&found)) {
      skipped_bytes += gone->count;
      last_skipped = gone->last;
    }
    const auto* const packet = std::get_if<packet_view>(&found);
    if (packet == nullptr) return;
    if (packet->is_zero()) {
      if (!all.empty()) all.back().byte_behind = skipped_bytes == 1 ? last_skipped : -1;
      all.push_back({{}, -1});
    } else {
      EXPECT_EQ(all.empty() ? 0U : skipped_bytes, 0U);
    }
    skipped_bytes = 0;
    if (!all.empty()) all.back().ct.push_back(packet->ct());
  });
  if (!all.empty()) all.pop_back();
  return all;
}

using reference::crc_8_maxim;

TEST(SimModels, ACrcByteIsSentWhereItIsKnown) {
  const auto sends = [](const std::string& word) {
    const auto all =
        revolutions_of(test::stream_of(test::options_of(word), 3 * second).bytes, word);
    EXPECT_GT(all.size(), 5U) << word;
    std::size_t fitting = 0;
    std::size_t none = 0;
    for (const revolution& each : all) {
      fitting += each.byte_behind == static_cast<int>(crc_8_maxim(each.ct)) ? 1U : 0U;
      none += each.byte_behind < 0 ? 1U : 0U;
    }
    if (fitting == all.size()) return std::string("crc");
    return std::string(none == all.size() ? "nothing" : "a byte");
  };
  const std::map<std::string, std::string> others{
      {"g4", "a byte"}, {"g4-pro", "a byte"}, {"g5", "a byte"},        {"x4-pro", "crc"},
      {"s2", "crc"},    {"s2-pro", "crc"},    {"s2-intensity", "crc"}, {"s2-pro-intensity", "crc"},
      {"tg15", "crc"},  {"tg30", "crc"},      {"tg50", "crc"}};
  for (const test::family_model& each : test::family_models) {
    const auto other = others.find(each.word);
    EXPECT_EQ(sends(each.word), other == others.end() ? "nothing" : other->second) << each.word;
  }
}

// A made-up device of the family's description: hardware 2, firmware 1.7, made on 2023-03-15 as the
// number 12345, with a defect of its sensor.
TEST(SimOneWay, CtHasTheInformation) {
  sim::device_options options = test::options_of("x4-pro");
  const std::string serial = "2023031500012345";
  std::ranges::copy(serial, options.info.serial_digits.begin());
  options.info.hardware = 2;
  options.info.firmware_major = 1;
  options.info.firmware_minor = 7;
  options.condition = {health_status::error, 1};
  options.scanner.scan_frequency_chz = 630;
  options.motor_drift_ppm = 0;
  const auto all = revolutions_of(test::stream_of(options, 3 * second).bytes, "x4-pro");
  ASSERT_GT(all.size(), 5U);
  const std::vector<std::uint8_t>& ct = all[3].ct;
  ASSERT_GT(ct.size(), 18U);
  EXPECT_EQ(ct[0], 0x7F);  // 6.3 Hz
  EXPECT_EQ(ct[3], 0x02);
  EXPECT_EQ(ct[4], 0x42);
  EXPECT_EQ(ct[5], 0x0E);
  EXPECT_EQ(ct[7] >> 1 & 15, 4);
  const std::vector<std::uint8_t> date_and_number(ct.begin() + 9, ct.begin() + 14);
  EXPECT_THAT(date_and_number, ElementsAre(0x18, 0x30, 0x78, 0xC0, 0x72));
  EXPECT_EQ(ct[17], 0);
  options.ct_information = false;
  const auto without = revolutions_of(test::stream_of(options, 3 * second).bytes, "x4-pro");
  EXPECT_EQ(without.at(3).ct.at(4), 0);
}

TEST(SimModels, ZeroPacketsReportTheFrequencyAsTheModelDoes) {
  const auto reported = [](const std::string& word, std::uint16_t chz) {
    sim::device_options options = test::options_of(word);
    options.scanner.scan_frequency_chz = chz;
    options.motor_drift_ppm = 0;
    int last_chz = -1;
    const byte_vector sent = test::stream_of(options, 3 * second).bytes;
    test::for_each_packet(sent, format_of(word), [&](packet_view packet, std::size_t) {
      if (packet.is_zero()) last_chz = packet.reported_frequency_chz();
    });
    return last_chz;
  };
  EXPECT_EQ(reported("g4", 700), 700);
  EXPECT_EQ(reported("g6", 1200), 1200);
  EXPECT_EQ(reported("x4", 700), 0) << "old firmware reports none";
  EXPECT_EQ(reported("x2", 650), 650);
  EXPECT_EQ(reported("t-mini-pro", 1000), 1000);
  EXPECT_EQ(reported("tg15", 690), 390) << "3 Hz too low";
  EXPECT_EQ(reported("tg50", 1600), 1270) << "the most that fits";
}

TEST(SimModels, FlagsAndIntensityAreThoseOfTheModel) {
  struct found {
    std::map<unsigned, std::size_t> of_returns;
    std::map<unsigned, std::size_t> of_others;
    std::uint16_t brightest = 0;
    std::uint16_t of_no_return = 0;
  };
  const auto look = [](const std::string& word) {
    sim::device_options options = test::options_of(word);
    options.scanner.dropout_ratio = 0.2;
    found seen;
    for (const sim::sent_sample& each : test::stream_of(options, 2 * second).truth) {
      const sim::sample_truth& truth = each.truth;
      ++(truth.raw != 0 ? seen.of_returns : seen.of_others)[truth.flags];
      std::uint16_t& most = truth.raw != 0 ? seen.brightest : seen.of_no_return;
      most = std::max(most, truth.intensity);
    }
    EXPECT_EQ(seen.of_no_return, 0) << word;
    return seen;
  };
  const auto bits = [](unsigned number) {
    unsigned count = 0;
    for (; number != 0; number /= 2) ++count;
    return count;
  };
  for (const char* const word : {"g4", "g6", "tg15", "tx8"}) {
    const found seen = look(word);
    EXPECT_EQ(seen.of_returns.size() + seen.of_others.size(), 2U) << word << " has flags";
    EXPECT_EQ(seen.brightest, 0) << word;
  }
  const found x4 = look("x4");
  EXPECT_GT(x4.of_returns.at(0), 15 * x4.of_returns.at(1));
  EXPECT_EQ(x4.of_others.count(1) + x4.of_others.count(3), 2U) << "flags without a return";
  EXPECT_EQ(x4.brightest, 0);
  const found t_mini = look("t-mini-pro");
  EXPECT_GT(t_mini.of_returns.at(2), 15 * t_mini.of_returns.at(3));
  EXPECT_EQ(t_mini.of_returns.size(), 2U);
  EXPECT_EQ(bits(t_mini.brightest), 8U);
  EXPECT_EQ(bits(look("scl").brightest), 8U);
  EXPECT_EQ(bits(look("g2").brightest), 10U);
  EXPECT_EQ(bits(look("t-mini-plus-sh").brightest), 16U);
}

// All that a G4 is not is set back, too.
TEST(SimModels, AModelAfterAnother_IsAsIfItWereTheFirst) {
  for (const test::family_model& each : test::family_models) {
    const byte_vector alone = test::stream_of(test::options_of(each.word), second / 2).bytes;
    for (const char* const before : {"tg15", "x4-pro"}) {
      sim::device_options twice = test::options_of(before);
      ASSERT_TRUE(sim::use_model(twice, each.word));
      EXPECT_EQ(test::stream_of(twice, second / 2).bytes, alone)
          << each.word << " after " << before;
    }
  }
}

TEST(SimModels, WithoutAModelItIsAG4) {
  sim::device_options options;
  options.truth_capacity = 100'000;
  EXPECT_EQ(test::stream_of(options, second).bytes,
            test::stream_of(test::options_of("g4"), second).bytes);
}

TEST(SimModels, ImpossibleOptionsOfAModel_AreNamed) {
  const auto problem = [](const std::string& word, auto&& change) {
    sim::device_options options = test::options_of(word);
    change(options.scanner);
    return std::string(sim::problem_with(options));
  };
  for (const test::family_model& each : test::family_models) {
    EXPECT_EQ(problem(each.word, [](auto&) {}), "") << each.word;
  }
  EXPECT_NE(problem("x4", [](auto& o) { o.samples_per_packet = 41; }), "");
  EXPECT_EQ(problem("g4", [](auto& o) { o.samples_per_packet = 80; }), "");
  EXPECT_NE(problem("x4", [](auto& o) { o.sample_rate = sample_rate::khz_8; }), "");
  EXPECT_EQ(problem("tg15", [](auto& o) { o.scan_frequency_chz = 300; }), "");
  EXPECT_NE(problem("tg15", [](auto& o) { o.scan_frequency_chz = 299; }), "");
  EXPECT_NE(problem("x2", [](auto& o) { o.scan_frequency_chz = 801; }), "");
  EXPECT_NE(problem("t-mini", [](auto& o) { o.min_range_mm = 0.5; }), "");
  EXPECT_NE(problem("t-mini", [](auto& o) { o.max_range_mm = 16'384; }), "");
  EXPECT_EQ(problem("tg50", [](auto& o) { o.max_range_mm = 65'535; }), "");
}

}  // namespace
}  // namespace g4lidar
