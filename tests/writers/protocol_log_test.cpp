// SPDX-License-Identifier: MIT
// The protocol log of bytes in both directions, compared with texts written by hand.
#include "export/protocol_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "support/packet_maker.hpp"

namespace g4lidar::test {
namespace {

using namespace g4_tool;
using ::testing::HasSubstr;
using ::testing::Not;

using byte_list = std::vector<std::uint8_t>;

byte_list packet(int first_deg, int last_deg, const std::vector<std::uint16_t>& samples,
                 unsigned ct = 0) {
  const made::packet made(ct, first_deg * 64, last_deg * 64, samples);
  return {made.data().begin(), made.data().end()};
}

/// The log of several items, one each 0.1 ms from 2 s on.
struct logged {
  explicit logged(const protocol_log_style& style = {})
      : sink([this](std::string_view more) { text += more; }),
        log(style, time_shift(time_style::monotonic, 0), sink) {}

  void from_device(const byte_list& data) { log.from_device(data, now_ns += 100'000); }
  void to_device(const byte_list& data) { log.to_device(data, now_ns += 100'000); }
  std::string finished() {
    log.finish();
    sink.flush();
    return text;
  }

  std::string text;
  callback_sink<std::function<void(std::string_view)>> sink;
  protocol_log log;
  std::int64_t now_ns = 2'000'000'000;
};

TEST(ProtocolLog, ADialogue) {
  logged seen;
  seen.log.remark("opened /dev/ttyUSB0", seen.now_ns);
  seen.to_device({0xA5, 0x91});
  seen.from_device({0xA5, 0x5A, 0x03, 0, 0, 0, 0x06, 0, 0, 0});
  seen.to_device({0xA5, 0x60});
  seen.from_device({0xA5, 0x5A, 0x05, 0x00, 0x00, 0x40, 0x81});
  seen.from_device(packet(0, 0, {4000}, 141));
  seen.from_device(packet(1, 10, {4000, 0, 300}));
  seen.from_device(packet(20, 19, {4000, 4000}));
  EXPECT_EQ(
      seen.finished(),
      "2.000000 - opened /dev/ttyUSB0\n"
      "2.000100 > health?  A5 91\n"
      "2.000200 < health: ok, code 0\n"
      "2.000300 > start  A5 60\n"
      "2.000400 < scan started\n"
      "2.000500 < packet   0.00 to   0.00 deg,  1 sample, checksum ok, zero packet, 7.0 Hz\n"
      "2.000600 < packet   1.00 to  10.00 deg,  3 samples, checksum ok\n"
      "2.000700 ! packet  20.00 to  19.00 deg,  2 samples, checksum ok, suspect: its angles go "
      "back  AA 55 00 02 01 0A 81 09 2A 54 A0 0F A0 0F\n");
  EXPECT_EQ(seen.log.commands(), 2U);
  EXPECT_EQ(seen.log.counts().packets, 3U);
}

TEST(ProtocolLog, SkippedBytesWithTheirReason) {
  logged seen({.has_times = false});
  seen.from_device({0x00, 0x13});
  seen.from_device(packet(30, 30, {4000}));
  seen.from_device(packet(31, 31, {4000}));
  const std::string text = seen.finished();
  EXPECT_EQ(text,
            "       0 ! skipped 2 bytes: noise  00 13\n"
            "       2 < packet  30.00 to  30.00 deg,  1 sample, checksum ok\n"
            "      14 < packet  31.00 to  31.00 deg,  1 sample, checksum ok\n");
}

TEST(ProtocolLog, AllBytesInHexadecimal) {
  logged seen({.hex = true});
  seen.to_device({0xA5, 0x60, 0xA5, 0x65});
  seen.from_device(packet(0, 0, {4000}));
  EXPECT_THAT(seen.finished(), HasSubstr("2.000100 > start\n    A5 60\n"
                                         "2.000100 > stop\n    A5 65\n"
                                         "2.000200 < packet   0.00 to   0.00 deg,  1 sample, "
                                         "checksum ok\n    AA 55 00 01 01 00 01 00 "));
}

TEST(ProtocolLog, ErrorsOnlyAndALimitOfLines) {
  logged errors({.errors = true});
  errors.to_device({0xA5, 0x60});
  errors.from_device(packet(0, 0, {4000}));
  errors.from_device(packet(20, 19, {4000, 4000}));
  EXPECT_THAT(errors.finished(), Not(HasSubstr(">")));
  EXPECT_THAT(errors.text, HasSubstr("suspect"));
  logged few({.lines = 2});
  for (int i = 0; i < 5; ++i) few.to_device({0xA5, 0x60});
  EXPECT_TRUE(few.log.is_done());
  EXPECT_EQ(few.finished(), "2.000100 > start  A5 60\n2.000200 > start  A5 60\n");
}

// Texts of a device or a recording are escaped for the terminal.
TEST(ProtocolLog, TextsAreEscaped) {
  logged seen;
  seen.log.remark("opened \x1B]0;gotcha\x07/dev/\nfoo", seen.now_ns);
  seen.from_device({'b', 'o', 'o', 't', 0x1B, '[', '2', 'J'});
  EXPECT_EQ(seen.finished(),
            "2.000000 - opened \\x1B]0;gotcha\\x07/dev/\\x0Afoo\n"
            "2.000100 ! skipped 8 bytes: noise  62 6F 6F 74 1B 5B 32 4A\n");
}

TEST(ProtocolLog, TimesBeforeTheEpochAndTheLargest) {
  logged seen;
  seen.log.remark("a", -1'500'000'000);
  seen.log.remark("b", INT64_MAX);
  seen.log.remark("c", INT64_MIN);
  EXPECT_EQ(seen.finished(), "-1.500000 - a\n9223372036.854775 - b\n-9223372036.854775 - c\n");
}

TEST(ProtocolLog, EachCommand_HasAName) {
  EXPECT_EQ(word_for_command(0x60), "start");
  EXPECT_EQ(word_for_command(0x65), "stop");
  EXPECT_EQ(word_for_command(0x90), "device information?");
  EXPECT_EQ(word_for_command(0xFF), "no command");
}

}  // namespace
}  // namespace g4lidar::test
