// SPDX-License-Identifier: MIT
// The counts over a stream: each event in its count, and every byte in exactly one.
#include "g4lidar/core/stream_counter.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string_view>
#include <vector>

#include "support/packet_maker.hpp"

namespace g4lidar {
namespace {

void append(std::vector<std::uint8_t>& stream, bytes more) {
  stream.insert(stream.end(), more.begin(), more.end());
}

TEST(StreamCounts, AreConsistentAtEveryMoment) {
  std::vector<std::uint8_t> stream{'b', 'o', 'o', 't'};
  append(stream, std::vector<std::uint8_t>{0xA5, 0x5A, 0x05, 0, 0, 0x40, 0x81});
  const made::packet good(0, 100, 1360, 40);
  append(stream, good.data());
  const made::packet suspect(0, 6400, 6390, 7);
  append(stream, suspect.data());
  const made::packet hurt(0, 100, 1360, 5);
  append(stream, hurt.data());
  stream.back() ^= 0x40;
  append(stream, std::vector<std::uint8_t>{0xAA, 0x55, 0x00, 0x51});  // 81 samples
  append(stream,
         std::vector<std::uint8_t>{0xAA, 0x55, 0x00, 0x00, 0x01, 0x10, 0x01, 0x10, 0xAA, 0x55});
  append(stream, good.data());
  append(stream, good.data().first(33));

  stream_parser parser;
  stream_counter counts;
  for (std::size_t i = 0; i < stream.size(); ++i) {
    parser.feed(bytes(stream).subspan(i, 1), [&](const event& found) { counts.add(found); });
    ASSERT_EQ(counts.parsed_bytes + counts.skipped_bytes() + parser.held(), i + 1);
  }
  while (const auto found = parser.finish()) counts.add(*found);

  EXPECT_EQ(counts.packets, 3U);
  EXPECT_EQ(counts.suspect, 1U);
  EXPECT_EQ(counts.points, 80U);
  EXPECT_EQ(counts.responses, 1U);
  EXPECT_EQ(counts.empty_packets, 1U);
  EXPECT_EQ(counts.parsed_bytes, 7U + 90U + 24U + 90U + 10U);
  EXPECT_EQ(counts.skipped(skip_reason::noise), 4U);
  EXPECT_EQ(counts.skipped(skip_reason::bad_checksum), 20U);
  EXPECT_EQ(counts.skipped(skip_reason::bad_header), 4U);
  EXPECT_EQ(counts.skipped(skip_reason::truncated), 33U);
  EXPECT_EQ(counts.parsed_bytes + counts.skipped_bytes(), stream.size());
  EXPECT_NE(counts, stream_counts{});
}

TEST(StreamCounts, EveryReason_HasANameAndACount) {
  constexpr std::string_view names[] = {"noise", "bad_header", "bad_checksum", "truncated"};
  static_assert(std::size(names) == skip_reasons);
  for (std::size_t i = 0; i < skip_reasons; ++i) {
    const auto reason = static_cast<skip_reason>(i);
    EXPECT_EQ(name_of(reason), names[i]);
    stream_counter counts;
    counts.add(skipped{17 + i, reason});
    EXPECT_EQ(counts.skipped(reason), 17 + i);
    EXPECT_EQ(counts.skipped_bytes(), 17 + i);
  }
}

}  // namespace
}  // namespace g4lidar
