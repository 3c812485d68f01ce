// SPDX-License-Identifier: MIT
// Frames of other makers, encoded here after their descriptions; not with the code under test.
#include "survey/other_makers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "support/test_scale.hpp"

namespace g4lidar {
namespace {

using byte_list = std::vector<std::uint8_t>;

void append(byte_list& to, const byte_list& more) { to.insert(to.end(), more.begin(), more.end()); }

std::uint8_t low(unsigned value) { return static_cast<std::uint8_t>(value & 0xFFU); }
std::uint8_t high(unsigned value) { return static_cast<std::uint8_t>(value >> 8U & 0xFFU); }
unsigned sum(const byte_list& all, std::size_t from = 0) {
  return std::accumulate(all.begin() + static_cast<std::ptrdiff_t>(from), all.end(), 0U);
}

byte_list ld19(unsigned i) {
  byte_list frame{0x54, 0x2C, 0x68, 0x08, low(i * 960), high(i * 960)};
  for (unsigned k = 0; k < 12; ++k) append(frame, {low(1000 + i + k), 0x03, 0xE4});
  append(frame, {0, 1, low(i), 0});
  // CRC-8 with the polynomial 4D, by long division of the bits.
  std::vector<bool> bits;
  for (const unsigned byte : frame) {
    for (int bit = 7; bit >= 0; --bit) bits.push_back((byte >> bit & 1U) != 0);
  }
  for (int bit = 0; bit < 8; ++bit) bits.push_back(false);
  constexpr std::string_view divisor = "101001101";
  for (std::size_t at = 0; at + 8 < bits.size(); ++at) {
    if (!bits[at]) continue;
    for (std::size_t k = 0; k < divisor.size(); ++k)
      bits[at + k] = bits[at + k] != (divisor[k] == '1');
  }
  unsigned rest = 0;
  for (std::size_t at = bits.size() - 8; at < bits.size(); ++at)
    rest = rest * 2 + (bits[at] ? 1 : 0);
  frame.push_back(low(rest));
  return frame;
}

byte_list xv11(unsigned i) {
  byte_list frame{0xFA, low(0xA0 + i % 90), 0x00, 0x4B};
  for (unsigned k = 0; k < 4; ++k) append(frame, {low(1000 + i), high(1000 + i), 200, 0});
  std::uint64_t all = 0;
  for (unsigned k = 0; k < 10; ++k)
    all += std::uint64_t{frame[2 * k] + 256U * frame[2 * k + 1]} << (9 - k);
  const auto check = static_cast<unsigned>((all % 32768 + all / 32768) % 32768);
  append(frame, {low(check), high(check)});
  return frame;
}

byte_list lds01(unsigned i) {
  byte_list frame{0xFA, low(0xA0 + i % 60), 0x2C, 0x01};
  frame.resize(42, 0x11);
  return frame;
}

byte_list delta(unsigned i) {
  byte_list frame{0xAA, 0, 0, 0x01, 0x61, 0xAD, 0, 11, 0x77, 0, 0, low(i), 0, 1, 2, 3, 4, 5, 6};
  frame[2] = low(static_cast<unsigned>(frame.size()));
  const unsigned check = sum(frame);
  append(frame, {high(check), low(check)});
  return frame;
}

byte_list camsense(unsigned i) {
  byte_list frame{0x55, 0xAA, 0x03, 0x08, 0x80, 0x4D, low(i * 50), 0xA1};
  frame.resize(36, 0x42);
  return frame;
}

byte_list gs2(unsigned i) {
  byte_list frame{0xA5, 0xA5, 0xA5, 0xA5, 0x01, 0x63, 0x42, 0x01};
  for (unsigned k = 0; k < 322; ++k) frame.push_back(low(k * 7 + i));
  frame.push_back(low(sum(frame, 4)));
  return frame;
}

byte_list sdm15(unsigned i) {
  byte_list frame{0xAA, 0x55, 0x60, 0x04, low(500 + i), 0x01, 0x30, 0x00};
  frame.push_back(low(sum(frame)));
  return frame;
}

byte_list capsules(unsigned i, std::size_t size) {
  byte_list frame{0, 0};
  for (std::size_t k = 2; k < size; ++k) frame.push_back(low(static_cast<unsigned>(k * 13 + i)));
  unsigned check = 0;
  for (std::size_t k = 2; k < size; ++k) check ^= frame[k];
  frame[0] = low(0xA0 | (check & 15U));
  frame[1] = low(0x50 | check >> 4U);
  return frame;
}
byte_list express(unsigned i) { return capsules(i, 84); }
byte_list ultra(unsigned i) { return capsules(i, 132); }

byte_list standard(unsigned i) {
  const unsigned angle = (i * 64 % 23040) << 1U | 1U;
  return {low(i % 360 == 0 ? 0x3D : 0x3E), low(angle), high(angle), 0x40, 0x1F};
}

byte_list text(std::string_view line) { return {line.begin(), line.end()}; }
byte_list nmea(unsigned i) {
  return text("$GNGGA,0236" + std::to_string(10 + i % 50) + ".00,4004.7,N,11614.2,E,1*58\r\n");
}

struct sender {
  std::string_view product;
  byte_list (*frame)(unsigned);
  unsigned enough;
};

constexpr unsigned five = 5;
constexpr unsigned fifty = 50;
constexpr std::array<sender, 11> senders{
    {{"an LD06, LD14, LD19 or STL of LDROBOT", ld19, five},
     {"an XV-11 of Neato, or an LDS with its frames", xv11, five},
     {"an LDS-01 (HLS-LFCD) of Hitachi-LG", lds01, fifty},
     {"a Delta of 3irobotix", delta, five},
     {"a Camsense X1", camsense, fifty},
     {"a GS of YDLIDAR, a line sensor", gs2, five},
     {"an SDM of YDLIDAR, a range finder", sdm15, five},
     {"an RPLIDAR of Slamtec", express, five},
     {"an RPLIDAR of Slamtec", ultra, five},
     {"an RPLIDAR of Slamtec", standard, fifty},
     {"a receiver of satellite positions (NMEA)", nmea, five}}};

std::string recognised(const byte_list& all, std::size_t piece = 4096) {
  maker_recogniser seen;
  for (std::size_t at = 0; at < all.size(); at += piece) {
    seen.take(bytes(all).subspan(at, std::min(piece, all.size() - at)));
  }
  seen.finish();
  return seen.found() == nullptr ? "" : std::string(seen.found()->product);
}

byte_list frames(const sender& of, unsigned count) {
  byte_list all;
  for (unsigned i = 0; i < count; ++i) append(all, of.frame(i + 1));
  return all;
}

TEST(OtherMakers, AreNamedAfterEnoughFramesInARow) {
  for (const sender& each : senders) {
    EXPECT_EQ(recognised(frames(each, each.enough)), each.product);
    EXPECT_EQ(recognised(frames(each, each.enough - 1)), "") << each.product;
  }
}

TEST(OtherMakers, AreNamedInsideOfAFrameAndHoweverTheBytesAreCut) {
  for (const sender& each : senders) {
    byte_list all = frames(each, each.enough + 2);
    all.erase(all.begin(), all.begin() + 3);
    for (const std::size_t piece : {1U, 7U, 100U, 5000U}) {
      EXPECT_EQ(recognised(all, piece), each.product) << piece;
    }
  }
}

TEST(OtherMakers, ADamagedFrameBeginsTheRowAgain) {
  for (const sender& each : senders) {
    byte_list all = frames(each, each.enough - 1);
    byte_list damaged = each.frame(1);
    damaged[0] ^= 0x41U;
    append(all, damaged);
    append(all, frames(each, each.enough - 1));
    EXPECT_EQ(recognised(all), "") << each.product;
  }
}

TEST(OtherMakers, TheGreetingOfACoinD4IsSufficient) {
  byte_list all{0xFE, 0xFE, 0xFA, 0xFA, 0xA5, 0x5A, 0x14, 0x00, 0xE3, 0x02, 0x01};
  append(all, text("COIN-D4"));
  EXPECT_EQ(recognised(all), "a COIN-D4 (LDS-03)");
}

const byte_list scan_begin{0xA5, 0x5A, 0x05, 0x00, 0x00, 0x40, 0x81};

byte_list after(byte_list head, const byte_list& more) {
  append(head, more);
  return head;
}

/// The device information of an RPLIDAR: its model, firmware, hardware, and 16 bytes of a serial number.
byte_list slamtec_information() {
  return {0xA5, 0x5A, 0x14, 0x00, 0x00, 0x00, 0x04, 0x18, 0x1D, 0x01, 0x07, 0x8D, 0x2C, 0xF3,
          0xF5, 0xC1, 0xE3, 0x9E, 0xC3, 0xA5, 0xE4, 0x9C, 0xF0, 0xFA, 0x2B, 0x49, 0x11};
}

TEST(OtherMakers, AnRplidarIsNamedByTheBeginOfItsScan) {
  byte_list samples;
  for (unsigned i = 1; i <= 11; ++i) append(samples, standard(i));
  EXPECT_EQ(recognised(after(scan_begin, samples)), "an RPLIDAR of Slamtec");
  const byte_list few(samples.begin(), samples.begin() + 30);
  EXPECT_EQ(recognised(after(scan_begin, few)), "");
  EXPECT_EQ(recognised(after({0xA5, 0x5A, 0x54, 0x00, 0x00, 0x40, 0x82}, express(1))),
            "an RPLIDAR of Slamtec");
  EXPECT_EQ(recognised(after({0xA5, 0x5A, 0x54, 0x00, 0x00, 0x40, 0x85}, express(1))),
            "an RPLIDAR of Slamtec");
  EXPECT_EQ(recognised(after({0xA5, 0x5A, 0x84, 0x00, 0x00, 0x40, 0x84}, ultra(1))),
            "an RPLIDAR of Slamtec");
  byte_list damaged = express(1);
  damaged[10] ^= 1U;
  EXPECT_EQ(recognised(after({0xA5, 0x5A, 0x54, 0x00, 0x00, 0x40, 0x82}, damaged)), "");
}

// A YDLIDAR has decimal digits there. Their answers about health, and at the begin of a scan, are equal.
TEST(OtherMakers, AnRplidarIsNamedByASerialNumberThatIsNotOfDigits) {
  const byte_list health{0xA5, 0x5A, 0x03, 0x00, 0x00, 0x00, 0x06, 0x00, 0x00, 0x00};
  EXPECT_EQ(recognised(slamtec_information()), "an RPLIDAR of Slamtec");
  EXPECT_EQ(recognised(after(slamtec_information(), health)), "an RPLIDAR of Slamtec");
  EXPECT_EQ(recognised(after(health, scan_begin)), "");
  // The example of the manual of a G4.
  const byte_list ours{0xA5, 0x5A, 0x14, 0x00, 0x00, 0x00, 0x04, 0x05, 0x02,
                       0x03, 0x03, 0x02, 0x00, 0x02, 0x01, 0x01, 0x00, 0x01,
                       0x00, 0x00, 0x00, 0x00, 0x07, 0x00, 0x00, 0x07, 0x03};
  EXPECT_EQ(recognised(after(ours, health)), "");
  // A part of it was lost, and packets follow.
  byte_list cut(ours.begin(), ours.begin() + 12);
  for (int i = 0; i < 40; ++i) append(cut, {0x94, 0x1F, 0x98, 0x1F});
  EXPECT_EQ(recognised(cut), "");
}

TEST(OtherMakers, AreNamedWithTheirDriver) {
  const auto with = [](std::string_view product) {
    for (const other_maker& each : other_makers()) {
      if (each.product == product) return with_driver(each);
    }
    return std::string();
  };
  EXPECT_EQ(with("a Delta of 3irobotix"), "a Delta of 3irobotix; its driver is delta_lidar");
  EXPECT_EQ(with("a receiver of satellite positions (NMEA)"),
            "a receiver of satellite positions (NMEA)");
}

// 10^7 bytes; more than 10^8 in the nightly.
TEST(OtherMakers, NoneIsNamedInRandomBytes) {
  for (const int seed : test::seeds(10)) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    maker_recogniser seen;
    byte_list piece(1'000'000);
    for (std::uint8_t& each : piece) each = low(static_cast<unsigned>(random()));
    seen.take(piece);
    ASSERT_EQ(seen.found(), nullptr) << seed << ": " << seen.found()->product;
  }
}

}  // namespace
}  // namespace g4lidar
