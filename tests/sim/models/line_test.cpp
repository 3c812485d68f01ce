// SPDX-License-Identifier: MIT
// The rate of the host's port: what a wrong one looks like in both directions, and which ones are right.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "family_stream.hpp"
#include "sim/device/line_receiver.hpp"

namespace g4lidar {
namespace {

using test::byte_vector;
using test::ms;
using test::second;
using ::testing::IsEmpty;

constexpr std::array<std::uint32_t, 5> rates{115'200, 128'000, 153'600, 230'400, 512'000};

/// What a receiver at another rate makes of bytes without a pause.
struct misread {
  byte_vector bytes;
  std::size_t unframed = 0;

  [[nodiscard]] double unframed_ratio() const {
    return static_cast<double>(unframed) / static_cast<double>(bytes.size());
  }
  [[nodiscard]] std::size_t headers() const {
    std::size_t found = 0;
    for (std::size_t i = 1; i < bytes.size(); ++i) {
      found += bytes[i - 1] == 0xAA && bytes[i] == 0x55 ? 1U : 0U;
    }
    return found;
  }
};
misread read_at(const byte_vector& sent, std::uint32_t sent_baud, std::uint32_t baud,
                std::uint64_t seed = 1) {
  misread got;
  sim::line_receiver receiver{sim::random_stream(seed)};
  const auto take = [&](std::uint8_t byte, bool is_framed) {
    got.bytes.push_back(byte);
    got.unframed += is_framed ? 0U : 1U;
  };
  std::int64_t count = 0;
  for (const std::uint8_t byte : sent) {
    receiver.hear(byte, ++count * 10 * second / sent_baud, sent_baud, baud, take);
  }
  receiver.rest((count + 10) * 10 * second / sent_baud, take);
  return got;
}

byte_vector x4_bytes() {
  byte_vector bytes = test::stream_of(test::options_of("x4"), second).bytes;
  bytes.resize(6000);
  return bytes;
}

std::size_t packets_in(const byte_vector& bytes) {
  std::size_t packets = 0;
  test::for_each_packet(bytes, model_named("x4")->samples,
                        [&](packet_view, std::size_t) { ++packets; });
  return packets;
}

// As real bytes of an X4 at another rate: no packet, most bytes without a stop bit, but few where the rate is
// the exact half. A header by chance is one in 65,536.
TEST(SimLine, AWrongRateNeverLooksRight) {
  const byte_vector sent = x4_bytes();
  std::size_t headers = 0;
  for (const std::uint32_t from : rates) {
    for (const std::uint32_t to : rates) {
      SCOPED_TRACE(std::to_string(from) + " read at " + std::to_string(to));
      const misread got = read_at(sent, from, to);
      if (from == to) {
        EXPECT_EQ(got.bytes, sent);
        EXPECT_EQ(got.unframed, 0U);
        continue;
      }
      EXPECT_EQ(packets_in(got.bytes), 0U);
      headers += got.headers();
      const bool is_half = from == 2 * to;
      EXPECT_GT(got.unframed_ratio(), is_half ? 0.0 : 0.5);
      EXPECT_LT(got.unframed_ratio(), is_half ? 0.15 : 0.95);
      const double ratio = static_cast<double>(got.bytes.size()) / static_cast<double>(sent.size());
      if (from > to) {
        EXPECT_LT(ratio, 1.05 * to / from) << "no more bytes than the receiver has time for";
      }
      if (from < to) {
        EXPECT_GT(ratio, 0.99) << "each byte of the sender has a start bit";
      }
    }
  }
  EXPECT_LE(headers, 2U);
}

TEST(SimLine, ASmallDifferenceIsRight) {
  const byte_vector sent = x4_bytes();
  const auto wrong = [&](std::uint32_t from, std::uint32_t to) {
    const byte_vector got = read_at(sent, from, to).bytes;
    std::size_t differ = 0;
    for (std::size_t i = 0; i < std::min(sent.size(), got.size()); ++i) {
      differ += sent[i] != got[i] ? 1U : 0U;
    }
    return differ;
  };
  EXPECT_EQ(wrong(512'000, 500'000), 0U) << "what a CP2102 sets";
  EXPECT_EQ(wrong(500'000, 512'000), 0U);
  EXPECT_EQ(wrong(128'000, 127'659), 0U);
  EXPECT_EQ(wrong(100'000, 98'000), 0U);
  EXPECT_GT(wrong(100'000, 96'000), 500U);
  EXPECT_GT(wrong(100'000, 107'000), 100U);
  EXPECT_TRUE(sim::is_same_rate(512'000, 500'000));
  EXPECT_FALSE(sim::is_same_rate(512'000, 495'000));
}

sim::device_options x4_options() { return test::options_of("x4"); }

TEST(SimLine, ADeviceIsHeardAtItsRateOnly) {
  for (const std::uint32_t baud : {115'200U, 127'659U, 128'000U, 153'600U, 230'400U, 512'000U}) {
    SCOPED_TRACE(baud);
    const bool is_right = baud == 128'000 || baud == 127'659;
    test::host_side host(x4_options());
    host.send(command::start);
    (void)host.listen(second);
    host.device.host().set_baud(baud, host.now_ns);
    EXPECT_EQ(host.device.host().baud(), baud);
    (void)host.listen(5 * ms);  // the bridge may still have bytes from before
    const byte_vector got = host.listen(second);
    EXPECT_GT(got.size(), 5000U);
    EXPECT_EQ(packets_in(got) > 100, is_right);
    EXPECT_TRUE(is_right || packets_in(got) == 0);
    // A stop arrives as something else; the log has what was taken for a command.
    host.device.clear_log();
    host.send(command::stop);
    (void)host.listen(100 * ms);
    EXPECT_EQ(host.device.is_scanning(), !is_right);
  }
}

TEST(SimLine, AQueryAtAnotherRateIsNotAnswered_AndDoesNothing) {
  for (const test::family_model& each : test::family_models) {
    for (const std::uint32_t baud : rates) {
      test::host_side host(test::options_of(each.word));
      if (!each.answers || baud == test::options_of(each.word).baud) continue;
      SCOPED_TRACE(each.word + " at " + std::to_string(baud));
      host.device.host().set_baud(baud, 0);
      EXPECT_THAT(host.ask(command::device_info, 300 * ms), IsEmpty());
      EXPECT_FALSE(host.device.is_scanning());
      host.device.host().set_baud(0, host.now_ns);
      EXPECT_EQ(host.ask(command::device_info).size(), 27U) << "at its own rate it answers";
    }
  }
}

TEST(SimLine, TheSameSeedGivesTheSameGarbage) {
  const auto garbage = [](std::uint64_t seed) {
    sim::device_options options = test::options_of("x2");
    options.scanner.seed = seed;
    test::host_side host(options);
    host.device.host().set_baud(230'400, 0);
    return host.listen(second);
  };
  EXPECT_GT(garbage(1).size(), 5000U);
  EXPECT_EQ(garbage(1), garbage(1));
  EXPECT_NE(garbage(1), garbage(2));
}

TEST(SimLine, PacketsThatNobodyCanReadAreNotWhole) {
  sim::device_options options = test::options_of("x2");
  test::host_side host(options);
  host.device.host().set_baud(230'400, 0);
  (void)host.listen(second);
  std::vector<sim::sent_sample> truth(10'000);
  truth.resize(host.device.take_truth(truth));
  ASSERT_GT(truth.size(), 2000U);
  for (const sim::sent_sample& each : truth) EXPECT_FALSE(each.whole);
}

TEST(SimLine, AnyRate_WithTheOption) {
  sim::device_options options = x4_options();
  options.any_baud = true;
  test::host_side host(options);
  host.device.host().set_baud(9600, 0);
  EXPECT_EQ(host.ask(command::device_info, 100 * ms).size(), 27U);
}

}  // namespace
}  // namespace g4lidar
