// SPDX-License-Identifier: MIT
// The CRC byte before zero packets: when it is a check, when it shows a lost packet, and when not.
#include "g4lidar/core/ct_information.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "g4lidar/core/stream_counter.hpp"
#include "support/crc_reference.hpp"
#include "support/packet_maker.hpp"
#include "turned_scans.hpp"

namespace g4lidar {
namespace {

using test::crc_mismatch;
using test::data_lost;
using test::start_missing;
using test::whole;

constexpr std::uint8_t crc_of(bytes data) {
  std::uint8_t crc = 0;
  for (const std::uint8_t byte : data) crc = next_crc(crc, byte);
  return crc;
}
// The check value of CRC-8/MAXIM in the catalogue of CRCs.
constexpr std::array<std::uint8_t, 9> digits{'1', '2', '3', '4', '5', '6', '7', '8', '9'};
static_assert(crc_of(digits) == 0xA1);

using reference::crc_8_maxim;
static_assert(crc_8_maxim(digits) == 0xA1);

/// A device with 36 packets in a revolution, and its bytes.
class revolving {
 public:
  /// The zero packet and the other packets of a revolution, without packet `omitted`.
  void turn(std::size_t omitted = 1000) {
    cts_.assign(1, 0x8F);
    add(made::zero(0, 4000, 0x8F >> 1));
    for (std::size_t i = 1; i <= 36; ++i) {
      const auto ct = static_cast<std::uint8_t>(i * 34 & 0xFE);
      cts_.push_back(ct);
      const int first = static_cast<int>(i - 1) * 640;
      if (i != omitted) add(made::packet(ct, first, first + 19 * 32, 20));
    }
  }
  void byte(std::uint8_t value) { stream_.push_back(value); }
  /// The byte that the device sends before the next zero packet.
  void crc() { byte(crc_8_maxim(cts_)); }
  void wrong_crc() { byte(static_cast<std::uint8_t>(crc_8_maxim(cts_) ^ 0x40U)); }
  void add(const made::packet& packet) {
    const bytes data = packet.data();
    stream_.insert(stream_.end(), data.begin(), data.end());
  }
  void good_turns(int count) {
    for (int i = 0; i < count; ++i) {
      turn();
      crc();
    }
  }
  std::vector<std::uint8_t>& stream() { return stream_; }

  /// The flags of all scans but the last piece.
  [[nodiscard]] std::vector<scan_flags> flags(std::size_t piece = 100'000) {
    counts_ = {};
    test::scan_cutter cutter(4000);
    stream_parser parser;
    const auto take = [&](const event& found) {
      counts_.add(found);
      if (counts_.crc.last() == ct_check::result::mismatch &&
          std::holds_alternative<packet_view>(found)) {
        cutter.crc_mismatch();
      }
      if (const auto* packet = std::get_if<packet_view>(&found)) cutter.feed(*packet);
      if (const auto* gone = std::get_if<skipped>(&found)) cutter.add(*gone);
    };
    for (bytes rest(stream_); !rest.empty();) {
      const std::size_t count = std::min(piece, rest.size());
      parser.feed(rest.first(count), take);
      rest = rest.subspan(count);
    }
    return test::marks_of(cutter);
  }
  [[nodiscard]] const stream_counter& counts() const { return counts_; }

 private:
  std::vector<std::uint8_t> cts_;
  std::vector<std::uint8_t> stream_;
  stream_counter counts_;
};

using all_marks = std::vector<scan_flags>;

TEST(CtCheck, AfterThreeFits_AMisfitIsALostPacket) {
  revolving device;
  device.good_turns(3);
  device.turn(17);
  device.crc();
  device.good_turns(1);
  device.turn();
  for (const std::size_t piece : {1U, 3U, 100'000U}) {
    EXPECT_EQ(device.flags(piece), (all_marks{whole, whole, whole, crc_mismatch, whole}));
    EXPECT_EQ(device.counts().crc_mismatches, 1U);
    EXPECT_EQ(device.counts().crc_matches, 2U);  // the third one, and the last
  }
  EXPECT_TRUE(device.counts().crc.is_trusted());
  EXPECT_EQ(device.counts().skipped(skip_reason::noise), 5U) << "the byte is noise to the parser";
  EXPECT_EQ(device.counts().parsed_bytes + 5, device.stream().size());
}

TEST(CtCheck, BeforeThreeFits_AMisfitIsNothing) {
  revolving device;
  device.good_turns(2);
  device.turn(5);
  device.crc();
  device.good_turns(2);
  device.turn();
  EXPECT_EQ(device.flags(), all_marks(5, whole));
  EXPECT_EQ(device.counts().crc_mismatches, 0U);
  EXPECT_FALSE(device.counts().crc.is_trusted());
}

TEST(CtCheck, ByteThatNeverFits_FlagsNothing) {
  revolving device;
  for (int i = 0; i < 50; ++i) {
    device.turn();
    device.wrong_crc();
  }
  device.turn();
  EXPECT_EQ(device.flags(), all_marks(50, whole));
  EXPECT_EQ(device.counts().crc_matches + device.counts().crc_mismatches, 0U);
}

// A byte that does not fit may fit three times by chance.
TEST(CtCheck, ByteThatMostlyMisfits_NeedsMoreFits) {
  revolving device;
  for (int i = 0; i < 10; ++i) {
    device.turn();
    device.wrong_crc();
  }
  device.good_turns(9);
  device.turn(3);
  device.crc();
  device.turn();
  EXPECT_EQ(device.flags(), all_marks(20, whole));
  // But a device that begins to send it is found.
  device.crc();
  device.good_turns(16);
  device.turn(3);
  device.crc();
  device.turn();
  EXPECT_EQ(device.flags().back(), crc_mismatch);
}

TEST(CtCheck, ByteThatStopsToFit_IsUnknownAgain) {
  revolving device;
  device.good_turns(4);
  for (int i = 0; i < 6; ++i) {
    device.turn();
    device.wrong_crc();
  }
  device.turn();
  all_marks expected(10, whole);
  for (std::size_t i = 4; i < 7; ++i) expected[i] = crc_mismatch;
  EXPECT_EQ(device.flags(), expected);
  EXPECT_FALSE(device.counts().crc.is_trusted());
}

TEST(CtCheck, DeviceThatStopsToSendIt_IsNotFlagged) {
  revolving device;
  device.good_turns(4);
  for (int i = 0; i < 6; ++i) device.turn();
  EXPECT_EQ(device.flags(), all_marks(9, whole));
  EXPECT_EQ(device.counts().crc_mismatches, 0U);
}

// What is known to be damaged is flagged as such, and proves nothing about the byte.
TEST(CtCheck, DamagedRevolution_IsNotCompared) {
  for (const bool loses_a_byte : {false, true}) {
    revolving device;
    device.good_turns(3);
    device.turn();
    device.crc();
    auto& stream = device.stream();
    const auto place = stream.end() - 30;  // in the last packet
    if (loses_a_byte) {
      stream.erase(place);
    } else {
      *place ^= 0x10;
    }
    device.turn();
    device.wrong_crc();
    device.turn();
    EXPECT_EQ(device.flags(), (all_marks{whole, whole, whole, data_lost, crc_mismatch}));
    EXPECT_EQ(device.counts().crc_mismatches, 1U);
  }
}

TEST(CtCheck, OtherStrayBytes_AreNotCompared) {
  revolving device;
  device.good_turns(3);
  device.turn();
  device.byte(0x00);
  device.wrong_crc();  // two bytes
  device.turn();
  device.byte(0x00);
  device.add(made::packet(0, 22400, 22430, 2));  // a byte within the revolution
  device.wrong_crc();
  device.turn();
  EXPECT_EQ(device.flags(), all_marks(5, whole));
  EXPECT_EQ(device.counts().crc_mismatches, 0U);
}

TEST(CtCheck, FirstRevolution_IsNotComparedIfItBeginsLate) {
  revolving device;
  device.good_turns(1);
  auto& stream = device.stream();
  stream.erase(stream.begin(), stream.begin() + 12 + 50 * 3);  // the zero packet and three more
  device.good_turns(3);
  device.turn(4);
  device.crc();
  device.turn();
  EXPECT_EQ(device.flags(), (all_marks{start_missing, whole, whole, whole, crc_mismatch}));
}

TEST(CtCheck, ScanHeader_BeginsAnew) {
  revolving device;
  device.good_turns(3);
  device.turn(4);
  for (const int byte : {0xA5, 0x5A, 0x05, 0x00, 0x00, 0x40, 0x81}) {
    device.byte(static_cast<std::uint8_t>(byte));
  }
  device.wrong_crc();
  device.turn(9);
  device.crc();
  device.turn();
  EXPECT_EQ(device.flags(), all_marks(5, whole));
  EXPECT_EQ(device.counts().crc_mismatches, 0U);
}

// A time packet or an answer between the packets changes nothing.
TEST(CtCheck, TimePacketBeforeTheByteOrBehindIt_IsNoDamage) {
  revolving device;
  const std::array<std::uint8_t, 8> clock{0xAA, 0x66, 0x27, 0xE8, 0x03, 0x00, 0x00, 0x00};
  const auto send_clock = [&] {
    for (const std::uint8_t byte : clock) device.byte(byte);
  };
  for (int i = 0; i < 4; ++i) {
    device.turn(i == 3 ? 7U : 1000U);
    if (i % 2 == 0) send_clock();
    device.crc();
    if (i % 2 != 0) send_clock();
  }
  device.turn();
  EXPECT_EQ(device.flags(), (all_marks{whole, whole, whole, crc_mismatch}));
  EXPECT_EQ(device.counts().time_packets, 4U);
}

}  // namespace
}  // namespace g4lidar
