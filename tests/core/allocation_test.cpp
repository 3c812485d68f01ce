// SPDX-License-Identifier: MIT
// The core never allocates: every part of it runs here under a counting allocator. Each part of the
// core has its own test.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "g4lidar/core/angle.hpp"
#include "g4lidar/core/command.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/response.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "support/allocation_count.hpp"
#include "support/packet_bytes.hpp"

namespace g4lidar {
namespace {

using test::allocations_in;
using test::append;
using test::buffer;
using test::packet_bytes;
using test::some_samples;
using test::wire_angle;

/// Packets, responses, noise, false starts and a damaged packet.
buffer mixed_stream() {
  buffer stream{'b', 'o', 'o', 't'};
  append(stream, {0xA5, 0x5A, 0x05, 0, 0, 0x40, 0x81, 0x00});
  for (unsigned i = 0; i < 50; ++i) {
    append(stream, packet_bytes(i % 10 == 0 ? 0x8D : 0, wire_angle(i * 400),
                                wire_angle(i * 400 + 300), some_samples(i % 10 == 0 ? 1 : 40)));
    if (i % 7 == 2) stream[stream.size() - 4] ^= 0x10;
    if (i % 7 == 4) append(stream, {0xAA, 0x55, 0x00, 0x50, 0x01, 0x10, 0xAA});
    if (i % 9 == 4) append(stream, {0xA5, 0x5A, 0x03, 0, 0, 0, 6, 1, 0x34, 0x12});
  }
  append(stream, {0xA5, 0x5A, 0x14, 0, 0, 0, 4, 5});
  return stream;
}

TEST(Allocation, CountsAllocations) {
  std::size_t size = 0;
  const std::size_t counted_calls = allocations_in([&size] {
    const std::string longer_than_any_small_string(200, 'x');
    static const char* volatile seen;  // otherwise a compiler may remove the allocation
    seen = longer_than_any_small_string.data();
    size = std::char_traits<char>::length(seen);
  });
  EXPECT_GE(counted_calls, 2U);
  EXPECT_EQ(size, 200U);
  EXPECT_EQ(allocations_in([] {}), 0U);
}

TEST(Allocation, NoneInParsing) {
  const buffer stream = mixed_stream();
  for (const std::size_t piece : {1UL, 3UL, 64UL, 1000000UL}) {
    std::size_t packets = 0;
    std::size_t sum = 0;
    EXPECT_EQ(allocations_in([&] {
                stream_parser parser;
                const auto use = [&](const event& found) {
                  if (const auto* packet = std::get_if<packet_view>(&found)) {
                    ++packets;
                    for (std::size_t i = 0; i < packet->sample_count(); ++i) {
                      sum += packet->sample(i);
                    }
                  } else if (const auto* reply = std::get_if<response_view>(&found)) {
                    sum += reply->as_health() ? reply->as_health()->error_code : 0U;
                  }
                };
                for (std::size_t from = 0; from < stream.size(); from += piece) {
                  parser.feed(bytes(stream).subspan(from, std::min(piece, stream.size() - from)),
                              use);
                }
                while (const auto found = parser.finish()) use(*found);
              }),
              0U)
        << piece;
    EXPECT_EQ(packets, 43U);
    EXPECT_GT(sum, 0U);
  }
}

TEST(Allocation, NoneInReadingRepliesAndAngles) {
  const buffer info{0xA5, 0x5A, 0x14, 0, 0, 0, 4, 5, 2, 3, 3, 2, 0, 2,
                    1,    1,    0,    1, 0, 0, 0, 0, 7, 0, 0, 7, 3};
  std::size_t digits = 0;
  EXPECT_EQ(allocations_in([&] {
              const auto found = response_view::from(info)->as_device_info();
              digits = found->serial_number().size();
              const auto traits = traits_of(command::protection_toggle);
              digits += encode(traits->code).size();
              digits += angle::from_degrees(1e9F) == angle{} ? 1U : 0U;
            }),
            0U);
  EXPECT_EQ(digits, 18U);
}

}  // namespace
}  // namespace g4lidar
