// SPDX-License-Identifier: MIT
// The stream of each format in all divisions, read as another format, and damaged.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include "family_stream.hpp"
#include "g4lidar/bulk_decoder.hpp"

namespace g4lidar {
namespace {

using test::byte_vector;
using test::family_model;

/// The events of a stream as text, with the bytes of packets.
class event_list {
 public:
  void operator()(const event& found) {
    if (const auto* const packet = std::get_if<packet_view>(&found)) {
      text_ << "packet";
      for (const unsigned byte : packet->data()) text_ << ' ' << byte;
      text_ << '\n';
    } else if (const auto* const gone = std::get_if<skipped>(&found)) {
      // Noise may be reported in pieces.
      for (std::size_t i = 0; i < gone->count; ++i) {
        text_ << "skipped " << static_cast<int>(gone->reason) << '\n';
      }
    } else {
      text_ << "another one\n";
    }
  }
  [[nodiscard]] std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
};

std::string events_of(const byte_vector& data, const sample_format& format, std::size_t piece) {
  event_list events;
  stream_parser parser(format);
  for (std::size_t from = 0; from < data.size(); from += piece) {
    parser.feed(bytes(data).subspan(from, std::min(piece, data.size() - from)), events);
  }
  while (const auto last = parser.finish()) events(*last);
  return events.text();
}

class SimLayout : public testing::TestWithParam<family_model> {
 protected:
  [[nodiscard]] const model& own() const { return *model_named(GetParam().word); }
  static byte_vector sent_in(std::int64_t duration_ns) {
    sim::device_options options = test::options_of(GetParam().word);
    options.scanner.dropout_ratio = 0.1;
    return test::stream_of(options, duration_ns).bytes;
  }
};

// With a scan header, a zero packet, a byte before it, packets of 40 and the rest of a revolution.
TEST_P(SimLayout, EveryDivision_GivesTheSameEvents) {
  const byte_vector all = sent_in(2 * test::second);
  std::vector<std::size_t> zeros;
  for (std::size_t i = 0; i + 3 < all.size(); ++i) {
    const bool is_zero = all[i] == 0xAA && all[i + 1] == 0x55 && (all[i + 2] & 1) != 0;
    if (is_zero && all[i + 3] == 1) zeros.push_back(i);
  }
  ASSERT_GE(zeros.size(), 2U);
  const std::size_t zero_at = zeros[zeros.size() - 2];
  ASSERT_GE(zero_at, 300U);
  const byte_vector data(all.begin() + static_cast<std::ptrdiff_t>(zero_at - 300),
                         all.begin() + static_cast<std::ptrdiff_t>(zero_at + 300));
  const std::string whole = events_of(data, own().samples, data.size());
  EXPECT_NE(whole.find("packet"), std::string::npos);
  for (std::size_t piece = 1; piece < data.size(); ++piece) {
    ASSERT_EQ(events_of(data, own().samples, piece), whole) << "pieces of " << piece;
  }
}

TEST_P(SimLayout, DamageIsFoundInEveryDivision) {
  byte_vector data = sent_in(test::second);
  data.resize(std::min<std::size_t>(data.size(), 700));
  for (std::size_t i = 40; i < data.size(); i += 97) data[i] ^= static_cast<std::uint8_t>(i);
  const std::string whole = events_of(data, own().samples, data.size());
  EXPECT_NE(whole.find("skipped"), std::string::npos);
  for (std::size_t piece = 1; piece < data.size(); ++piece) {
    ASSERT_EQ(events_of(data, own().samples, piece), whole) << "pieces of " << piece;
  }
}

TEST_P(SimLayout, ReadAsEachOther_ItIsCountedAndBounded) {
  const byte_vector data = sent_in(2 * test::second);
  std::size_t packets = 0;
  test::for_each_packet(data, own().samples, [&](packet_view, std::size_t) { ++packets; });
  ASSERT_GT(packets, 100U);
  for (const family_model& other : test::models_of_each_format()) {
    SCOPED_TRACE("as " + other.word);
    const model& as = *model_named(other.word);
    bulk_decoder decoder(as);
    std::vector<point> out(data.size() / 2 + max_samples);
    bytes input(data);
    std::size_t points = decoder.decode(input, out).size();
    points += decoder.finish(std::span(out).subspan(points)).size();
    const stream_counts& counts = decoder.counts();
    EXPECT_TRUE(input.empty());
    EXPECT_EQ(counts.parsed_bytes + counts.skipped_bytes() + decoder.held(), data.size());
    EXPECT_LE(points, counts.packets * as.samples.max_samples);
    for (const point& p : std::span(out).first(points)) {
      ASSERT_TRUE(p.angle_deg >= 0.0F && p.angle_deg < 360.0F) << p.angle_deg;
      ASSERT_TRUE(p.range_mm >= 0.0F && p.range_mm <= 65'535.0F) << p.range_mm;
    }
    if (sample_size(as.samples.layout) == sample_size(own().samples.layout)) {
      EXPECT_EQ(counts.packets, packets) << "the same size";
      continue;
    }
    // Zero packets with small values, and a packet with the next one, may fit by chance.
    EXPECT_LT(counts.packets, packets / 3);
    EXPECT_GT(counts.skipped(skip_reason::bad_checksum), data.size() / 3);
  }
}

TEST_P(SimLayout, ATruncatedPacketIsNoPacket) {
  const byte_vector data = sent_in(test::second);
  std::size_t seen = 0;
  test::for_each_packet(data, own().samples, [&](packet_view packet, std::size_t) {
    if (++seen > 20) return;
    const bytes whole = packet.data();
    for (std::size_t size = 0; size < whole.size(); ++size) {
      EXPECT_FALSE(packet_view::from(whole.first(size), own().samples).has_value()) << size;
    }
    byte_vector longer(whole.begin(), whole.end());
    longer.push_back(0);
    EXPECT_FALSE(packet_view::from(longer, own().samples).has_value());
  });
  EXPECT_GT(seen, 20U);
}

TEST_P(SimLayout, MoreSamplesThanTheModelSends_AreRefused) {
  const sample_format& format = own().samples;
  const reference::wire_format& how = GetParam().format();
  for (unsigned count = 1; count <= 120; ++count) {
    const auto packet = reference::packet_of(how, 0, 6400, 7040,
                                             std::vector<reference::wire_sample>(count, {7, 4000}));
    const bool is_possible = count <= format.max_samples;
    EXPECT_EQ(packet_view::from(packet, format).has_value(), is_possible) << count;
    stream_parser parser(format);
    std::size_t packets = 0;
    std::size_t taken = 0;
    const auto take = [&](const event& found) {
      if (std::holds_alternative<packet_view>(found)) ++packets;
      if (const auto* const gone = std::get_if<skipped>(&found)) taken += gone->count;
    };
    parser.feed(packet, take);
    while (const auto last = parser.finish()) take(*last);
    EXPECT_EQ(packets, is_possible ? 1U : 0U) << count;
    EXPECT_EQ(taken, is_possible ? 0U : packet.size()) << count;
  }
}

INSTANTIATE_TEST_SUITE_P(OfTheFamily, SimLayout, testing::ValuesIn(test::models_of_each_format()),
                         [](const auto& each) {
                           std::string name = each.param.word;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace g4lidar
