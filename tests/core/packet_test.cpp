// SPDX-License-Identifier: MIT
// The packet on the wire: the protocol's examples, every limit, every single-bit error.
#include "g4lidar/core/packet.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "support/packet_bytes.hpp"
#include "support/reference_parser.hpp"

namespace g4lidar {
namespace {

using test::append;
using test::buffer;
using test::fix_checksum;
using test::packet_bytes;
using test::some_samples;
using test::wire_angle;

constexpr std::array<std::uint8_t, 12> zero_packet{0xAA, 0x55, 0x01, 0x01, 0x53, 0xAE,
                                                   0x53, 0xAE, 0xAB, 0x54, 0x00, 0x00};
/// The packet of the manual (LSN 28, FSA 6FE5, LSA 79BD), reduced to its header, its example of a
/// sample (E5 6F) and a second one.
constexpr std::array<std::uint8_t, 14> two_samples{0xAA, 0x55, 0x00, 0x02, 0xE5, 0x6F, 0xBD,
                                                   0x79, 0xB7, 0x21, 0xE5, 0x6F, 0xA0, 0x0F};

constexpr wire_check valid(std::size_t size) { return {wire_state::valid, size}; }
constexpr wire_check incomplete(std::size_t size) { return {wire_state::incomplete, size}; }
constexpr wire_check bad_header(std::size_t size) { return {wire_state::bad_header, size}; }
constexpr wire_check bad_checksum(std::size_t size) { return {wire_state::bad_checksum, size}; }

static_assert(max_packet_size == 170);
static_assert(std::is_trivially_copyable_v<packet_view>);

// ---- The protocol's examples at compile time ---------------------------------------------------
static_assert(check_packet(zero_packet) == valid(12));
static_assert(packet_checksum(zero_packet) == 0x54AB);
static_assert(packet_view::from(zero_packet)->is_zero());
static_assert(packet_view::from(zero_packet)->reported_frequency_chz() == 0);
static_assert(packet_view::from(zero_packet)->sample_count() == 1);
static_assert(packet_view::from(zero_packet)->sample(0) == 0);
static_assert(packet_view::from(zero_packet)->first_angle_64ths() == 0xAE53 / 2);
static_assert(packet_view::from(zero_packet)->last_angle_64ths() == 0xAE53 / 2);
static_assert(packet_view::from(zero_packet)->span_64ths() == 0);
static_assert(!packet_view::from(zero_packet)->is_suspect());

static_assert(check_packet(two_samples) == valid(14));
static_assert(packet_view::from(two_samples)->sample(0) / 4.0 == 7161.25);
static_assert(packet_view::from(two_samples)->first_angle_64ths() / 64.0 == 223.78125);
static_assert(packet_view::from(two_samples)->last_angle_64ths() / 64.0 == 243.46875);
static_assert(packet_view::from(two_samples)->span_64ths() / 64.0 == 19.6875);
static_assert(!packet_view::from(two_samples)->is_zero());

/// Frequency = byte / 10 Hz: CT's upper seven bits. In 0.01 Hz.
constexpr int frequency_of_ct(std::uint8_t ct) {
  std::array<std::uint8_t, 12> packet = zero_packet;
  packet[2] = ct;
  packet[8] = static_cast<std::uint8_t>(packet[8] ^ 0x01 ^ ct);
  return packet_view::from(packet)->reported_frequency_chz();
}
static_assert(frequency_of_ct(0x01) == 0);
static_assert(frequency_of_ct(0x8D) == 700);
static_assert(frequency_of_ct(0xFF) == 1270);
static_assert(frequency_of_ct(0x8C) == 0, "not a zero packet: its upper bits mean nothing");

TEST(Packet, TheVendorsZeroPacket) {
  const auto packet = packet_view::from(zero_packet);
  ASSERT_TRUE(packet);
  EXPECT_TRUE(packet->is_zero());
  EXPECT_EQ(packet->ct(), 1);
  EXPECT_EQ(packet->sample_count(), 1U);
  EXPECT_EQ(packet->sample(0), 0);
  EXPECT_EQ(packet->first_angle_64ths(), 22313);
  EXPECT_EQ(packet->data().data(), zero_packet.data()) << "seen where it lies";
  EXPECT_EQ(packet->data().size(), 12U);
  EXPECT_EQ(packet_checksum(zero_packet), 0x54AB);
}

TEST(Packet, TheManualsFortySamples) {
  std::vector<std::uint16_t> samples = some_samples(40);
  samples.front() = 4 * 1000;
  samples[7] = 0x6FE5;
  samples.back() = 4 * 8000;
  const buffer data = packet_bytes(0x00, 0x6FE5, 0x79BD, samples);
  ASSERT_EQ(data[3], 0x28);
  ASSERT_EQ(data[10 + 14], 0xE5);
  ASSERT_EQ(data[10 + 15], 0x6F);

  const auto packet = packet_view::from(data);
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->sample_count(), 40U);
  EXPECT_EQ(packet->first_angle_64ths() / 64.0, 223.78125);
  EXPECT_EQ(packet->last_angle_64ths() / 64.0, 243.46875);
  EXPECT_EQ(packet->span_64ths() / 64.0, 19.6875);
  EXPECT_EQ(packet->sample(0) / 4.0, 1000.0);
  EXPECT_EQ(packet->sample(7) / 4.0, 7161.25);
  EXPECT_EQ(packet->sample(39) / 4.0, 8000.0);
  EXPECT_FALSE(packet->is_suspect());

  std::array<std::uint16_t, max_samples> copied{};
  copied.fill(0xFFFF);
  packet->copy_samples(copied);
  for (std::size_t i = 0; i < max_samples; ++i) {
    EXPECT_EQ(copied[i], i < 40 ? samples[i] : 0) << i;
  }
}

TEST(Packet, AllSampleValues_ArePossible) {
  std::vector<std::uint16_t> samples = some_samples(80);
  for (std::size_t i = 0; i < 80; ++i) {
    for (unsigned value = 0; value < 65536; value += 257) {
      samples[i] = static_cast<std::uint16_t>(value);
      const auto data = packet_bytes(0, wire_angle(640), wire_angle(960), samples);
      const auto packet = packet_view::from(data);
      ASSERT_TRUE(packet);
      ASSERT_EQ(packet->sample(i), value) << i;
    }
  }
}

TEST(Packet, UpperBitsOfCt_AreIgnoredButChecksummed) {
  const buffer data = packet_bytes(0x86, wire_angle(9600), wire_angle(10224), some_samples(40));
  const auto packet = packet_view::from(data);
  ASSERT_TRUE(packet);
  EXPECT_FALSE(packet->is_zero());
  EXPECT_EQ(packet->ct(), 0x86);
  EXPECT_EQ(packet->reported_frequency_chz(), 0);

  buffer masked = data;  // the checksum of a vendor document that masks CT to bit 0
  masked[8] ^= 0x86;
  EXPECT_EQ(check_packet(masked), bad_checksum(90));
}

TEST(Packet, AnyCtIsPossible) {
  for (unsigned ct = 0; ct < 256; ++ct) {
    const auto data = packet_bytes(ct, wire_angle(640), wire_angle(640), {1234});
    const auto packet = packet_view::from(data);
    ASSERT_TRUE(packet) << ct;
    EXPECT_EQ(packet->is_zero(), ct % 2 == 1) << ct;
    EXPECT_EQ(packet->reported_frequency_chz(), ct % 2 == 1 ? static_cast<int>(ct / 2) * 10 : 0)
        << ct;
  }
}

TEST(Packet, SampleCountsUpTo80ArePossible) {
  for (unsigned n = 0; n < 256; ++n) {
    const buffer data = packet_bytes(0, wire_angle(640), wire_angle(960), some_samples(n));
    const wire_check wanted = n <= 80 ? valid(10 + 2 * n) : bad_header(4);
    EXPECT_EQ(check_packet(data), wanted) << n;
    EXPECT_EQ(packet_view::from(data).has_value(), n >= 1 && n <= 80) << n;
  }
}

TEST(Packet, Angles_NeedTheCheckBitAndAreBelow360) {
  for (unsigned raw = 0; raw < 65536; ++raw) {
    const bool possible = raw % 2 == 1 && raw / 2 < 23040;
    const buffer as_first = packet_bytes(0, raw, 0x0101, {4000});
    const buffer as_last = packet_bytes(0, 0x0101, raw, {4000});
    const wire_check first = check_packet(as_first);
    const wire_check last = check_packet(as_last);
    const std::size_t seen_at = raw % 2 == 1 ? 1 : 0;  // the first impossible byte
    ASSERT_EQ(first, possible ? valid(12) : bad_header(5 + seen_at)) << raw;
    ASSERT_EQ(last, possible ? valid(12) : bad_header(7 + seen_at)) << raw;
    if (!possible) continue;
    ASSERT_EQ(packet_view::from(as_first)->first_angle_64ths(), static_cast<int>(raw / 2));
    ASSERT_EQ(packet_view::from(as_last)->last_angle_64ths(), static_cast<int>(raw / 2));
  }
}

TEST(Packet, AngleBackwardsWithoutAWrap_IsSuspect) {
  struct example {
    unsigned first, last;
    bool suspect;
    int span;
  };
  const unsigned d90 = 90 * 64;
  const unsigned d270 = 270 * 64;
  const example examples[] = {
      {0, 0, false, 0},
      {0, 23039, false, 23039},
      {6400, 6400, false, 0},
      {6400, 6401, false, 1},
      {6400, 6399, true, -1},
      {23039, 0, false, 1},
      {23039, 23038, true, -1},
      {d270 + 1, d90 - 1, false, 180 * 64 - 2},
      {d270, d90 - 1, true, static_cast<int>(d90) - 1 - static_cast<int>(d270)},
      {d270 + 1, d90, true, static_cast<int>(d90) - 1 - static_cast<int>(d270)},
      {d270 + 1, d270, true, -1},
      {d90 - 1, 0, true, 1 - static_cast<int>(d90)},
      {d90, d270, false, 180 * 64},
  };
  for (const example& e : examples) {
    for (const unsigned ct : {0U, 1U}) {
      const auto data = packet_bytes(ct, wire_angle(e.first), wire_angle(e.last), {1, 2});
      const auto packet = packet_view::from(data);
      ASSERT_TRUE(packet);
      EXPECT_EQ(packet->is_suspect(), e.suspect) << e.first << " to " << e.last;
      EXPECT_EQ(packet->span_64ths(), e.span) << e.first << " to " << e.last;
      EXPECT_EQ(packet->is_zero(), ct == 1);
    }
  }
}

TEST(Packet, OneSample_MayHaveTwoAngles) {
  const auto data = packet_bytes(0, wire_angle(640), wire_angle(960), {4000});
  const auto packet = packet_view::from(data);
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->span_64ths(), 320);
}

TEST(Packet, EveryPrefix_IsIncompleteWithTheMissingSize) {
  for (const std::size_t n : {1U, 2U, 3U, 40U, 79U, 80U}) {
    const buffer data = packet_bytes(1, wire_angle(22000), wire_angle(100), some_samples(n));
    for (std::size_t have = 0; have < data.size(); ++have) {
      const bytes front = bytes(data).first(have);
      EXPECT_EQ(check_packet(front), incomplete(have < 8 ? have + 1 : data.size())) << have;
      EXPECT_FALSE(packet_view::from(front));
    }
    EXPECT_EQ(check_packet(data), valid(data.size()));
  }
}

TEST(Packet, FollowingBytes_ChangeNothing) {
  buffer data = packet_bytes(0, wire_angle(640), wire_angle(960), some_samples(7));
  const std::size_t size = data.size();
  for (int i = 0; i < 20; ++i) {
    data.push_back(static_cast<std::uint8_t>(0xAA - i));
    EXPECT_EQ(check_packet(data), valid(size));
    EXPECT_FALSE(packet_view::from(data)) << "a view is of one packet, no more";
  }
}

TEST(Packet, Refused_AtTheFirstImpossibleByte) {
  // One impossible byte at a time, in a header whose other bytes are possible.
  const buffer good = packet_bytes(0, wire_angle(640), wire_angle(960), some_samples(3));
  const std::array<std::uint8_t, 8> bad{0xAB, 0x56, 0, 81, 0x80, 0xB4, 0x82, 0xFF};
  for (std::size_t at = 0; at < bad.size(); ++at) {
    if (at == 2) continue;  // CT may be anything
    buffer data = good;
    data[at] = bad[at];
    for (std::size_t have = 0; have <= data.size(); ++have) {
      const wire_check check = check_packet(bytes(data).first(have));
      EXPECT_EQ(check, have <= at ? incomplete(have + 1) : bad_header(at + 1)) << at << " " << have;
    }
  }
}

/// All lengths n for which the checksum of the packet at the front of `data` matches if its LSN
/// byte is n, found by trying; `data` holds the packet and the bytes behind it.
std::vector<std::size_t> counts_with_agreeing_checksum(buffer data) {
  std::vector<std::size_t> counts;
  for (std::size_t n = 0; n <= 80 && 10 + 2 * n <= data.size(); ++n) {
    data[3] = static_cast<std::uint8_t>(n);
    const int sum = reference::checksum_of(reference::window(data, 0));
    if (sum == data[8] + 256 * data[9]) counts.push_back(n);
  }
  return counts;
}

/// Flips each bit of the packet at the front of `stream` and checks the front then. Returns how
/// many flips of LSN gave a valid packet; the reference has named each of them.
std::size_t survivors_of_single_bit_errors(const buffer& stream) {
  const std::size_t size = 10 + 2 * std::size_t{stream[3]};
  const std::vector<std::size_t> agreeing = counts_with_agreeing_checksum(stream);
  std::size_t survivors = 0;
  for (std::size_t bit = 0; bit < 8 * size; ++bit) {
    buffer damaged = stream;
    damaged[bit / 8] = static_cast<std::uint8_t>(damaged[bit / 8] ^ 1U << bit % 8);
    const wire_check check = check_packet(damaged);
    const bool in_lsn = bit / 8 == 3;
    const std::size_t n = damaged[3];
    const bool may_survive =
        in_lsn && std::find(agreeing.begin(), agreeing.end(), n) != agreeing.end();
    EXPECT_EQ(check.state == wire_state::valid, may_survive) << "bit " << bit << " of " << size;
    if (may_survive) {
      EXPECT_EQ(check.size, 10 + 2 * n);
      ++survivors;
    }
    if (!in_lsn) {
      EXPECT_TRUE(check.state == wire_state::bad_checksum || check.state == wire_state::bad_header);
    }
  }
  return survivors;
}

TEST(Packet, EverySingleBitError_IsRefused) {
  for (const std::size_t n : {1U, 2U, 3U, 8U, 16U, 39U, 40U, 64U, 79U, 80U}) {
    buffer stream = packet_bytes(0x86, wire_angle(12345), wire_angle(13456), some_samples(n));
    for (int i = 0; i < 8; ++i) {  // bytes behind it, for a larger LSN
      append(stream, packet_bytes(0, wire_angle(14000), wire_angle(15000), some_samples(20, 777)));
    }
    EXPECT_EQ(survivors_of_single_bit_errors(stream), 0U) << n;
  }
}

TEST(Packet, SampleCountError_PassesIfTheChecksumMatches) {
  // LSN 8 becomes 9, 10, 12, 24, 40, 72 or 0; the checksum then includes some of the following
  // bytes. For each of them the following bytes are chosen so that it matches.
  for (const std::size_t n : {9U, 10U, 12U, 24U, 40U, 72U}) {
    buffer stream = packet_bytes(0, wire_angle(12345), wire_angle(13456), some_samples(8));
    stream.resize(stream.size() + 2 * 72);
    for (std::size_t i = 26; i < stream.size(); ++i) stream[i] = static_cast<std::uint8_t>(7 * i);
    int rest = 8 * 256 ^ static_cast<int>(n) * 256;  // LSN's own change, then the samples
    for (std::size_t i = 26; i < 10 + 2 * n; i += 2) rest ^= stream[i] + 256 * stream[i + 1];
    stream[26] = static_cast<std::uint8_t>(stream[26] ^ (rest & 0xFF));
    stream[27] = static_cast<std::uint8_t>(stream[27] ^ rest >> 8);
    EXPECT_EQ(survivors_of_single_bit_errors(stream), 1U) << n;
  }
  // And smaller: LSN 9 becomes 8 if the ninth sample compensates for it.
  buffer shorter = packet_bytes(0, wire_angle(12345), wire_angle(13456), some_samples(9));
  shorter[26] = 0x00;
  shorter[27] = 0x09 ^ 0x08;
  fix_checksum(shorter);
  EXPECT_EQ(survivors_of_single_bit_errors(shorter), 1U);
}

TEST(Packet, Checksum_AgreesWithTheReferenceForEveryLength) {
  std::uint32_t state = 1;
  for (std::size_t n = 1; n <= 80; ++n) {
    buffer data(10 + 2 * n);
    for (std::uint8_t& byte : data) {
      state = state * 1664525U + 1013904223U;
      byte = static_cast<std::uint8_t>(state >> 24);
    }
    data[0] = 0xAA;
    data[1] = 0x55;
    data[3] = static_cast<std::uint8_t>(n);
    EXPECT_EQ(packet_checksum(data), reference::checksum_of(reference::window(data, 0))) << n;
  }
}

}  // namespace
}  // namespace g4lidar
