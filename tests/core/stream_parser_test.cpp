// SPDX-License-Identifier: MIT
// The promises of the streaming parser one by one; transcripts and properties test all of them
// together.
#include "g4lidar/core/stream_parser.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "support/packet_bytes.hpp"
#include "support/reference_parser.hpp"
#include "support/stream_log.hpp"

namespace g4lidar {
namespace {

using test::append;
using test::buffer;
using test::packet_bytes;
using test::some_samples;
using test::wire_angle;

constexpr std::array<std::uint8_t, 12> zero_packet{0xAA, 0x55, 0x01, 0x01, 0x53, 0xAE,
                                                   0x53, 0xAE, 0xAB, 0x54, 0x00, 0x00};

static_assert(sizeof(stream_parser) < max_packet_size + 256);
static_assert(std::is_trivially_copyable_v<event>);

template <class Parser, class Input>
concept can_pull = requires(Parser&& parser, Input&& input) {
  static_cast<Parser&&>(parser).next(static_cast<Input&&>(input));
};
static_assert(can_pull<stream_parser&, bytes&>);
static_assert(!can_pull<stream_parser&, bytes>, "what is left of a temporary would be lost");
static_assert(!can_pull<stream_parser, bytes&>, "the carry would die with the parser");

// ---- The specification: what stands at the front -----------------------------------------------
constexpr front front_of(std::initializer_list<std::uint8_t> data) {
  return what_stands_at_front(bytes(data.begin(), data.size()));
}
static_assert(what_stands_at_front(zero_packet) ==
              front{front_kind::packet, skip_reason::noise, 12, 12});
static_assert(front_of({0xA5, 0x5A, 5, 0, 0, 0x40, 0x81, 0}) ==
              front{front_kind::response, skip_reason::noise, 7, 7});
static_assert(front_of({1, 2, 3, 0xAA, 4}) == front{front_kind::skip, skip_reason::noise, 5, 5});
static_assert(front_of({1, 2, 3, 0xAA, 0x55}) == front{front_kind::skip, skip_reason::noise, 3, 3});
static_assert(front_of({1, 0xA5, 0x55, 0xA5, 0x5A}) ==
              front{front_kind::skip, skip_reason::noise, 3, 3});
static_assert(front_of({1, 2, 3, 0xA5}) == front{front_kind::skip, skip_reason::noise, 3, 3});
static_assert(front_of({1, 2}) == front{front_kind::skip, skip_reason::noise, 2, 2});
static_assert(front_of({0xAA, 1}) == front{front_kind::skip, skip_reason::noise, 2, 2});
static_assert(front_of({0xAA, 0xAA, 0x55}) == front{front_kind::skip, skip_reason::noise, 1, 1});
static_assert(front_of({0xA5, 0xAA}) == front{front_kind::skip, skip_reason::noise, 1, 1});
static_assert(front_of({0xAA}).kind == front_kind::incomplete);
static_assert(front_of({0xAA, 0x55, 0, 81}) ==
              front{front_kind::skip, skip_reason::bad_header, 1, 4});
static_assert(front_of({0xA5, 0x5A, 2}) == front{front_kind::skip, skip_reason::bad_header, 1, 3});
static_assert(front_of({0xAA, 0x55, 0, 1, 1, 0, 1, 0, 0, 0, 0, 0}) ==
              front{front_kind::skip, skip_reason::bad_checksum, 1, 12});

std::vector<event> all_events(stream_parser& parser, bytes input) {
  std::vector<event> events;
  while (const auto found = parser.next(input)) events.push_back(*found);
  return events;
}

/// Several valid packets, with a response and noise among them.
buffer busy_stream() {
  buffer stream;
  for (unsigned i = 0; i < 40; ++i) {
    const unsigned angle = i * 500;
    append(stream, packet_bytes(i % 10 == 0 ? 1 : 0, wire_angle(angle), wire_angle(angle + 400),
                                some_samples(i % 10 == 0 ? 1 : 2 * i + 1)));
    if (i % 8 == 3) append(stream, {0xA5, 0x5A, 0x01, 0, 0, 0, 4, 1});
    if (i % 8 == 5) append(stream, {0x00, 0xAA, 0xA5, 0x17});
  }
  return stream;
}

TEST(StreamParser, CompletePacket_IsViewedInPlace) {
  const buffer stream = packet_bytes(0, wire_angle(64), wire_angle(128), some_samples(20));
  stream_parser parser;
  bytes input(stream);
  const auto found = parser.next(input);
  ASSERT_TRUE(found && std::holds_alternative<packet_view>(*found));
  EXPECT_EQ(std::get<packet_view>(*found).data().data(), stream.data());
  EXPECT_TRUE(input.empty());
  EXPECT_FALSE(parser.next(input));
  EXPECT_EQ(parser.held(), 0U);
}

TEST(StreamParser, PacketBehindACarriedOne_IsViewedInPlace) {
  buffer stream = packet_bytes(0, wire_angle(64), wire_angle(128), some_samples(20));
  const std::size_t size = stream.size();
  append(stream, stream);
  stream_parser parser;
  bytes first = bytes(stream).first(size - 3);
  EXPECT_FALSE(parser.next(first));
  EXPECT_EQ(parser.held(), size - 3);
  bytes rest = bytes(stream).subspan(size - 3);
  const auto carried = parser.next(rest);
  ASSERT_TRUE(carried && std::holds_alternative<packet_view>(*carried));
  EXPECT_EQ(rest.size(), size) << "no more is taken into the carry than the packet needs";
  const auto in_place = parser.next(rest);
  ASSERT_TRUE(in_place && std::holds_alternative<packet_view>(*in_place));
  EXPECT_EQ(std::get<packet_view>(*in_place).data().data(), stream.data() + size);
}

TEST(StreamParser, EventIsValidUntilTheNextCall) {
  const buffer stream = busy_stream();
  for (std::size_t piece = 1; piece < 200; ++piece) {
    stream_parser parser;
    std::size_t reported = 0;
    for (std::size_t from = 0; from < stream.size(); from += piece) {
      bytes input = bytes(stream).subspan(from, std::min(piece, stream.size() - from));
      while (const auto found = parser.next(input)) {
        if (const auto* packet = std::get_if<packet_view>(&*found)) {
          ASSERT_TRUE(packet_view::from(packet->data())) << "a view is of a valid packet";
          ASSERT_TRUE(std::equal(packet->data().begin(), packet->data().end(),
                                 stream.begin() + static_cast<std::ptrdiff_t>(reported)));
        }
        reported += size_of(*found);
      }
    }
    EXPECT_EQ(reported, stream.size());
  }
}

TEST(StreamParser, FeedPushesTheSameEvents) {
  const buffer stream = busy_stream();
  for (const std::size_t piece : {1UL, 7UL, 64UL, 100000UL}) {
    stream_parser pulled;
    stream_parser pushed;
    for (std::size_t from = 0; from < stream.size(); from += piece) {
      const bytes input = bytes(stream).subspan(from, std::min(piece, stream.size() - from));
      bytes left = input;
      pushed.feed(input, [&](const event& found) {
        const auto wanted = pulled.next(left);
        ASSERT_TRUE(wanted);
        EXPECT_EQ(test::kind_of(found), test::kind_of(*wanted));
        EXPECT_EQ(size_of(found), size_of(*wanted));
      });
      EXPECT_FALSE(pulled.next(left));
      EXPECT_EQ(pushed.held(), pulled.held());
    }
  }
}

TEST(StreamParser, EmptyInputChangesNothing) {
  const buffer stream = packet_bytes(0, wire_angle(64), wire_angle(128), some_samples(20));
  stream_parser parser;
  for (const std::uint8_t& byte : stream) {
    bytes nothing;
    EXPECT_FALSE(parser.next(nothing));
    const auto held = parser.held();
    EXPECT_FALSE(parser.next(nothing));
    EXPECT_EQ(parser.held(), held);
    bytes one(&byte, 1);
    const bool last = &byte == &stream.back();
    EXPECT_EQ(parser.next(one).has_value(), last);
  }
}

TEST(StreamParser, DamagedPacket_HidesNoFollowingPacket) {
  // A header that claims 80 samples, and three packets within its claim.
  buffer stream = packet_bytes(0, wire_angle(64), wire_angle(128), some_samples(80));
  stream.resize(8);
  for (int i = 0; i < 3; ++i) append(stream, {zero_packet.begin(), zero_packet.end()});
  stream_parser parser;
  EXPECT_TRUE(all_events(parser, stream).empty()) << "it may still be a packet";
  EXPECT_EQ(parser.held(), stream.size());
  std::size_t packets = 0;
  std::size_t lost = 0;
  while (const auto found = parser.finish()) {
    if (const auto* gone = std::get_if<skipped>(&*found)) {
      EXPECT_EQ(gone->reason, skip_reason::truncated);
      lost += gone->count;
    } else {
      ++packets;
    }
  }
  EXPECT_EQ(packets, 3U);
  EXPECT_EQ(lost, 8U);
}

TEST(StreamParser, Finish_ResetsTheParser) {
  const buffer stream = busy_stream();
  const reference::reading wanted = reference::read(stream);
  stream_parser parser;
  for (std::size_t dirt = 0; dirt < stream.size(); dirt += 13) {
    static_cast<void>(all_events(parser, bytes(stream).first(dirt)));
    while (parser.finish()) {
    }
    EXPECT_EQ(parser.held(), 0U);
    test::stream_log log(stream);
    log.feed(parser, stream.size());
    log.finish(parser);
    ASSERT_EQ(test::difference(log, wanted), "") << dirt;
  }
}

TEST(StreamParser, IncompleteFinish_Continues) {
  buffer stream = packet_bytes(0, wire_angle(64), wire_angle(128), some_samples(80));
  stream.resize(30);
  stream_parser parser;
  std::size_t reported = 0;
  bytes input(stream);
  EXPECT_FALSE(parser.next(input));
  const auto first = parser.finish();
  ASSERT_TRUE(first);
  reported += size_of(*first);
  input = zero_packet;
  std::size_t packets = 0;
  while (const auto found = parser.next(input)) {
    reported += size_of(*found);
    packets += std::holds_alternative<packet_view>(*found) ? 1U : 0U;
  }
  EXPECT_EQ(packets, 1U);
  EXPECT_EQ(reported + parser.held(), 30 + zero_packet.size());
}

TEST(StreamParser, Copy_IsIndependent) {
  const buffer stream = packet_bytes(0, wire_angle(64), wire_angle(128), some_samples(20));
  stream_parser parser;
  bytes input = bytes(stream).first(20);
  EXPECT_FALSE(parser.next(input));
  stream_parser copy = parser;
  EXPECT_EQ(all_events(parser, bytes(stream).subspan(20)).size(), 1U);
  EXPECT_EQ(copy.held(), 20U);
  EXPECT_EQ(all_events(copy, bytes(stream).subspan(20)).size(), 1U);
}

constexpr std::size_t packets_in(bytes input) {
  stream_parser parser;
  std::size_t packets = 0;
  for (std::size_t i = 0; i < input.size(); ++i) {
    parser.feed(input.subspan(i, 1), [&](const event& found) {
      packets += std::holds_alternative<packet_view>(found) ? 1U : 0U;
    });
  }
  return packets;
}
static_assert(packets_in(zero_packet) == 1, "the whole parser works at compile time");

}  // namespace
}  // namespace g4lidar
