// SPDX-License-Identifier: MIT
// The bulk decoder, with each instruction set, compared with decode() with the exact correction:
// the same points for every input, every division of it, and every size of the output.
#include "g4lidar/recording/bulk_decoder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <variant>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "support/family_reference.hpp"
#include "support/packet_maker.hpp"
#include "support/random_stream.hpp"
#include "support/reference_points.hpp"
#include "support/test_scale.hpp"

namespace g4lidar {
namespace {

constexpr double angle_bound_deg = 4e-5;
constexpr double place_bound = 1e-6;  // of the range

using buffer = std::vector<std::uint8_t>;

/// The results of the parser and decode() for an input, and all counts.
struct expectation {
  std::vector<point> points;
  stream_counter counts;
};

expectation expected_of(bytes input) {
  expectation result;
  stream_parser parser;
  revolution_counter revolutions;
  std::array<point, max_samples> out;
  const auto take = [&](const event& found) {
    result.counts.add(found);
    if (const auto* packet = std::get_if<packet_view>(&found)) {
      const auto got = decode(*packet, exact_correction{}, revolutions.count(*packet), out).points;
      result.points.insert(result.points.end(), got.begin(), got.end());
    }
  };
  parser.feed(input, take);
  while (const auto found = parser.finish()) take(*found);
  return result;
}

void expect_same(std::span<const point> got, std::span<const point> expected) {
  ASSERT_EQ(got.size(), expected.size());
  double worst = 0.0;
  for (std::size_t i = 0; i < got.size(); ++i) {
    ASSERT_GE(got[i].angle_deg, 0.0F);
    ASSERT_LT(got[i].angle_deg, 360.0F);
    worst = std::max(worst, reference::apart_deg(static_cast<double>(got[i].angle_deg),
                                                 static_cast<double>(expected[i].angle_deg)));
    point rest = got[i];
    rest.angle_deg = expected[i].angle_deg;
    ASSERT_EQ(rest, expected[i]) << "point " << i;
  }
  EXPECT_LE(worst, angle_bound_deg);
}

void expect_same_places(std::span<const xy_point> got, bytes packet, frame to,
                        std::uint16_t turn_deg = 180) {
  const std::vector<reference::sample> expected = reference::samples_of(packet);
  ASSERT_EQ(got.size(), expected.size());
  for (std::size_t i = 0; i < got.size(); ++i) {
    ASSERT_EQ(got[i].time_ns, 0);
    const auto& [raw, range_mm, first_level, angle_deg] = expected[i];
    if (reference::is_no_return(raw)) {
      ASSERT_TRUE(std::isnan(got[i].x_m) && std::isnan(got[i].y_m));
      continue;
    }
    const double native = angle_deg * std::numbers::pi / 180.0;
    const bool is_mirrored = to == frame::robot;
    const double x_side = is_mirrored && turn_deg == 180 ? -1.0 : 1.0;
    const double y_side = is_mirrored && turn_deg == 0 ? -1.0 : 1.0;
    const double x_m = range_mm / 1000.0 * std::cos(native) * x_side;
    const double y_m = range_mm / 1000.0 * std::sin(native) * y_side;
    const double off =
        std::hypot(static_cast<double>(got[i].x_m) - x_m, static_cast<double>(got[i].y_m) - y_m);
    ASSERT_LE(off, place_bound * range_mm / 1000.0) << "raw " << raw << " at " << angle_deg;
  }
}

class BulkDecoder : public testing::TestWithParam<instruction_set> {
 protected:
  void SetUp() override {
    if (bulk_decoder(GetParam()).in_use() != GetParam()) {
      GTEST_SKIP() << "this processor has no " << name_of(GetParam());
    }
  }
  [[nodiscard]] static bulk_decoder make() { return bulk_decoder(GetParam()); }

  /// Compares the points and the positions of one packet with the references. Its bytes end at the
  /// end of their memory, so that the address sanitizer detects a read behind them.
  static void check_packet(const made::packet& packet) {
    const buffer data(packet.data().begin(), packet.data().end());
    std::vector<point> points(max_samples);
    bytes input = data;
    bulk_decoder decoder = make();
    expect_same(decoder.decode(input, points), expected_of(data).points);
    ASSERT_TRUE(input.empty());
    for (const frame to : {frame::vendor, frame::robot}) {
      std::vector<xy_point> places(max_samples);
      input = data;
      expect_same_places(decoder.decode_xy(input, to, places), data, to);
    }
    model turned_otherwise = g4_model;
    turned_otherwise.turn_deg = 0;
    bulk_decoder other(turned_otherwise, GetParam());
    std::vector<xy_point> places(max_samples);
    input = data;
    expect_same_places(other.decode_xy(input, frame::robot, places), data, frame::robot, 0);
  }
};

INSTANTIATE_TEST_SUITE_P(Each, BulkDecoder,
                         testing::Values(instruction_set::portable, instruction_set::avx2),
                         [](const auto& made) { return std::string(name_of(made.param)); });

TEST_P(BulkDecoder, AgreesForAllSamples) {
  std::vector<std::uint16_t> raw(max_samples);
  for (unsigned from = 0; from < 65536; from += max_samples) {
    for (unsigned i = 0; i < max_samples; ++i) raw[i] = static_cast<std::uint16_t>(from + i);
    const int first = static_cast<int>(from * 7 % 23040);
    check_packet(made::packet(0, first, std::min(first + 2048, 23039), raw));
    if (HasFailure()) return;
  }
}

TEST_P(BulkDecoder, AgreesForAllSampleCountsAndAnglesAroundTheCircle) {
  test::dice random(1);
  for (std::size_t count = 1; count <= max_samples; ++count) {
    for (int first = 0; first < 23040; first += 23 * 64 + 1) {
      // Far and near targets, none, and packets of far ones only.
      std::vector<std::uint16_t> raw(count);
      const std::size_t nearest = random.below(2) == 0 ? 1 : 400;
      for (std::uint16_t& sample : raw) {
        const std::size_t far = nearest + random.below(65536 - nearest);
        sample = static_cast<std::uint16_t>(random.below(6) == 0 ? 0 : far);
      }
      const int last = (first + static_cast<int>(random.below(3000))) % 23040;
      check_packet(made::packet(count == 1 ? 1 : 0, first, last, raw));
      if (HasFailure()) return;
    }
  }
}

TEST_P(BulkDecoder, WrapsOnBothSidesOfZero) {
  std::vector<std::uint16_t> raw(max_samples);
  for (std::size_t i = 0; i < raw.size(); ++i) {
    raw[i] = static_cast<std::uint16_t>(400 + i * i * 10);  // from +4.5 degrees to -7.9
  }
  for (int angle = 0; angle < 10 * 64; ++angle) {
    check_packet(made::packet(0, angle, angle, raw));
    check_packet(made::packet(0, 23039 - angle, 23039 - angle, raw));
    check_packet(made::packet(0, 23039 - angle, 640 - angle, raw));
    check_packet(made::packet(0, 20000, 23039 - angle, raw));
    if (HasFailure()) return;
  }
  check_packet(made::packet(0, 0, 23039, raw));
}

TEST_P(BulkDecoder, SuspectPacket_GivesNoPointsButCountsItsRevolution) {
  buffer data;
  for (const made::packet& packet : {made::packet(1, 640, 640, 3), made::packet(1, 6400, 6336, 9),
                                     made::packet(0, 70, 80, 40)}) {
    data.insert(data.end(), packet.data().begin(), packet.data().end());
  }
  std::vector<point> out(200);
  bytes input = data;
  bulk_decoder decoder = make();
  const auto got = decoder.decode(input, out);
  expect_same(got, expected_of(data).points);
  ASSERT_EQ(got.size(), 43U);
  EXPECT_EQ(got.back().revolution, 1U);
  EXPECT_EQ(decoder.counts().suspect, 1U);
}

TEST_P(BulkDecoder, AgreesForDamagedStreamsInPiecesOfAnySize) {
  test::dice random(7);
  for (int round = 0; round < 400 * test::test_scale(); ++round) {
    test::random_stream stream;
    for (std::size_t parts = 1 + random.below(25); parts > 0; --parts) {
      stream.add({random.byte(), random.next()});
    }
    for (std::size_t harms = random.below(5); harms > 0; --harms) {
      stream.damage({random.byte(), random.next()});
    }
    const buffer data = stream.data();
    const expectation expected = expected_of(data);

    bulk_decoder decoder = make();
    std::vector<point> got;
    const std::size_t most_room = round % 2 == 0 ? 300 : 90;
    const auto with_room = [&](const auto& decode_into) {
      const std::size_t size = random.below(most_room);
      std::vector<point> room(size + 1, point{.range_mm = -1.0F});  // and one more
      const auto points = decode_into(std::span(room).first(size));
      ASSERT_EQ(room.back().range_mm, -1.0F);
      got.insert(got.end(), points.begin(), points.end());
    };
    for (std::size_t at = 0; at < data.size();) {
      const std::size_t size = std::min(1 + random.below(400), data.size() - at);
      bytes piece = bytes(data).subspan(at, size);
      at += size;
      while (!piece.empty()) {
        with_room([&](std::span<point> out) { return decoder.decode(piece, out); });
      }
      ASSERT_EQ(decoder.counts().parsed_bytes + decoder.counts().skipped_bytes() + decoder.held(),
                at);
    }
    do {
      with_room([&](std::span<point> out) { return decoder.finish(out); });
    } while (decoder.held() > 0);
    expect_same(got, expected.points);
    ASSERT_EQ(decoder.counts(), expected.counts);
    if (HasFailure()) return;
  }
}

TEST_P(BulkDecoder, PacketWithoutRoom_StaysInTheInput) {
  const made::packet packet(0, 6400, 7000, 40);
  buffer data(packet.data().begin(), packet.data().end());
  data.insert(data.end(), packet.data().begin(), packet.data().end());
  std::array<point, 79> out;
  bulk_decoder decoder = make();
  bytes input = data;
  EXPECT_EQ(decoder.decode(input, std::span(out).first(39)).size(), 0U);
  EXPECT_EQ(input.size(), 180U);
  EXPECT_EQ(decoder.counts(), stream_counts{});
  EXPECT_EQ(decoder.decode(input, out).size(), 40U);
  EXPECT_EQ(input.size(), 90U);
  EXPECT_EQ(decoder.decode(input, std::span(out).first(40)).size(), 40U);
  EXPECT_TRUE(input.empty());
  EXPECT_EQ(decoder.counts().packets, 2U);
}

TEST_P(BulkDecoder, FinishFindsThePointsInAFalseStart) {
  const made::packet packet = made::zero(640);
  buffer data{0xAA, 0x55, 0x00, 80, 0x01, 0x02, 0x01, 0x02, 0, 0};
  data.insert(data.end(), packet.data().begin(), packet.data().end());
  std::array<xy_point, max_samples> out;
  bulk_decoder decoder = make();
  bytes input = data;
  EXPECT_EQ(decoder.decode_xy(input, frame::robot, out).size(), 0U);
  EXPECT_TRUE(input.empty());
  EXPECT_EQ(decoder.held(), data.size());
  expect_same_places(decoder.finish_xy(frame::robot, out), packet.data(), frame::robot);
  EXPECT_EQ(decoder.held(), 0U);
}

TEST(BulkDecoderChoice, SelectsTheBestInstructionSet_OrPortable) {
  EXPECT_EQ(bulk_decoder().in_use(), best_instruction_set());
  EXPECT_EQ(bulk_decoder(instruction_set::portable).in_use(), instruction_set::portable);
  EXPECT_STREQ(name_of(instruction_set::portable), "portable");
  EXPECT_STREQ(name_of(instruction_set::avx2), "AVX2");
}

/// An answer of four bytes.
buffer answer_of(std::int32_t number) {
  buffer made{0xA5, 0x5A, 4, 0, 0, 0, 4};
  for (unsigned shift = 0; shift < 32; shift += 8) {
    made.push_back(static_cast<std::uint8_t>(static_cast<std::uint32_t>(number) >> shift));
  }
  return made;
}

// family: in quarters of a degree, added to each angle.
TEST_P(BulkDecoder, TheOffsetOfZeroIsAdded) {
  const auto& how = reference::wire_format_of("tg15");
  const model& tg = *model_named("tg15");
  const buffer packet = reference::packet_of(how, 0, 10 * 64, 49 * 64,
                                             std::vector<reference::wire_sample>(40, {0, 2000}));
  for (const double deg : {-90.25, 180.0, 270.5}) {
    for (const bool is_given : {false, true}) {
      buffer data;
      bulk_decoder decoder(tg, GetParam());
      EXPECT_FALSE(decoder.zero().angle());
      if (is_given) {
        decoder.zero().set({static_cast<std::int32_t>(std::lround(100 * deg))},
                           zero_offset::stated_by::user);
        data = answer_of(-4);  // the user knows better
      } else {
        data = {0xA5, 0x5A, 5, 0, 0, 0x40, 0x81};
        const buffer answer = answer_of(static_cast<std::int32_t>(std::lround(4 * deg)));
        data.insert(data.end(), answer.begin(), answer.end());
      }
      data.insert(data.end(), packet.begin(), packet.end());
      std::vector<point> points(max_samples);
      bytes input = data;
      const auto got = decoder.decode(input, points);
      ASSERT_EQ(got.size(), 40U);
      for (std::size_t i = 0; i < got.size(); ++i) {
        const double wanted_deg = 10.0 + static_cast<double>(i) + deg;
        EXPECT_LT(reference::apart_deg(static_cast<double>(got[i].angle_deg), wanted_deg), 1e-3);
      }
      for (const frame to : {frame::vendor, frame::robot}) {
        std::vector<xy_point> places(max_samples);
        bytes again = packet;
        const auto found = decoder.decode_xy(again, to, places);
        ASSERT_EQ(found.size(), 40U);
        for (std::size_t i = 0; i < found.size(); ++i) {
          const double vendor_deg = 10.0 + static_cast<double>(i) + deg;
          const double angle_deg = to == frame::vendor ? vendor_deg : 180.0 - vendor_deg;
          const double rad = angle_deg * std::numbers::pi / 180.0;
          EXPECT_NEAR(static_cast<double>(found[i].x_m), 2.0 * std::cos(rad), 1e-4);
          EXPECT_NEAR(static_cast<double>(found[i].y_m), 2.0 * std::sin(rad), 1e-4);
        }
      }
    }
  }
}

// family: a TG up to firmware 1.2 sends half millimetres.
TEST_P(BulkDecoder, TheFirmwareDecides) {
  const auto& how = reference::wire_format_of("tg15");
  buffer data{0xA5, 0x5A, 0x14, 0, 0, 0, 0x04, 100, 2, 1, 1};
  data.resize(7 + 20);
  const buffer packet = reference::packet_of(how, 0, 10 * 64, 49 * 64,
                                             std::vector<reference::wire_sample>(40, {0, 2000}));
  data.insert(data.end(), packet.begin(), packet.end());
  bulk_decoder decoder(*model_named("tg15"), GetParam());
  std::vector<point> points(max_samples);
  bytes input = data;
  const auto got = decoder.decode(input, points);
  ASSERT_EQ(got.size(), 40U);
  for (const point& each : got) EXPECT_EQ(each.range_mm, 1000.0F);
}

}  // namespace
}  // namespace g4lidar
