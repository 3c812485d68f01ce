// SPDX-License-Identifier: MIT
// Every layout of samples on random packets: the points against a reference in double precision, and
// what a parser for another layout makes of them.
#include <gtest/gtest.h>
// GoogleTest first.
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <random>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "g4lidar/core/decode.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/recording/bulk_decoder.hpp"
#include "support/check_cases.hpp"
#include "support/family_reference.hpp"

namespace g4lidar {
namespace {

using reference::wire_format;
using reference::wire_sample;
using test::check_cases;

struct random_packet {
  unsigned first, last;
  std::vector<wire_sample> samples;
  std::vector<std::uint8_t> data;
};

/// Ranges of all lengths: also those of a few units, and none.
unsigned any_word() {
  return *rc::gen::oneOf(rc::gen::inRange(0U, 8U), rc::gen::inRange(0U, 1000U),
                         rc::gen::inRange(0U, 65'536U));
}

random_packet any_packet(const wire_format& how) {
  random_packet made{};
  const auto count =
      *rc::gen::inRange<std::size_t>(1, static_cast<std::size_t>(how.most_samples) + 1);
  made.first = *rc::gen::inRange(0U, 23'040U);
  const unsigned way = *rc::gen::inRange(0U, 23'040U - std::min(made.first, 23'039U));
  made.last = made.first + way;
  if (made.first > 271 * 64 && *rc::gen::arbitrary<bool>()) {
    made.last = *rc::gen::inRange(0U, 89U * 64U);  // through zero
  }
  if (count == 1) made.last = made.first;
  const unsigned most_before = how.sample_bytes == 3 ? 256U : 65'536U;
  for (std::size_t i = 0; i < count; ++i) {
    const unsigned before = how.sample_bytes == 2 ? 0U : *rc::gen::inRange(0U, most_before);
    made.samples.push_back({before, any_word()});
  }
  const unsigned ct = *rc::gen::inRange(0U, 256U) / 2 * 2 + (count == 1 ? 1U : 0U);
  made.data = reference::packet_of(how, ct, made.first, made.last, made.samples);
  return made;
}

void expect_points(const wire_format& how, const model& which, const random_packet& packet,
                   std::span<const point> points) {
  RC_ASSERT(points.size() == packet.samples.size());
  double way = (static_cast<double>(packet.last) - packet.first) / 64.0;
  if (way < 0.0) way += 360.0;
  const auto gaps = static_cast<double>(points.size() - 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double step = gaps > 0.0 ? way / gaps * static_cast<double>(i) : 0.0;
    const auto wanted = reference::point_of(how, packet.first / 64.0 + step, packet.samples[i]);
    const point& p = points[i];
    RC_ASSERT(static_cast<double>(p.range_mm) == wanted.range_mm);
    RC_ASSERT(p.is_no_return() == (wanted.range_mm == 0.0));
    RC_ASSERT(p.is_too_near() == (wanted.range_mm > 0.0 && wanted.range_mm < which.range.min_mm));
    RC_ASSERT(p.intensity == wanted.intensity);
    RC_ASSERT(p.sample_flags == wanted.flags);
    RC_ASSERT(p.angle_deg >= 0.0F && p.angle_deg < 360.0F);
    RC_ASSERT(reference::apart_deg(static_cast<double>(p.angle_deg), wanted.angle_deg) < 1e-4);
  }
}

class SampleLayout : public testing::TestWithParam<wire_format> {};

TEST_P(SampleLayout, PointsAreThoseOfTheReference) {
  const wire_format& how = GetParam();
  const model& which = *model_named(how.model);
  check_cases(300, [&] {
    const random_packet packet = any_packet(how);
    for (const instruction_set set : {instruction_set::portable, best_instruction_set()}) {
      bulk_decoder decoder(which, set);
      std::array<point, max_samples> out{};
      bytes input(packet.data);
      expect_points(how, which, packet, decoder.decode(input, out));
      RC_ASSERT(decoder.counts().packets == 1U);
    }
  });
}

// The nearest targets that the fast kernels process: their corrections are the largest ones.
TEST_P(SampleLayout, PointsWrapOnBothSidesOfZero) {
  const wire_format& how = GetParam();
  const model& which = *model_named(how.model);
  for (unsigned first = 340 * 64; first < 380 * 64; first += 7) {
    random_packet packet{first % 23'040, (first + 5) % 23'040, {}, {}};
    for (unsigned i = 0; i < 40; ++i) {
      const unsigned range_mm = std::max<unsigned>(100, which.range.min_mm) + 2 * i;
      const auto units = static_cast<unsigned>(range_mm / how.mm_per_unit);
      packet.samples.push_back({0, units << static_cast<unsigned>(how.low_bits)});
    }
    packet.data = reference::packet_of(how, 0, packet.first, packet.last, packet.samples);
    for (const instruction_set set : {instruction_set::portable, best_instruction_set()}) {
      SCOPED_TRACE(name_of(set));
      bulk_decoder decoder(which, set);
      std::array<point, max_samples> out{};
      bytes input(packet.data);
      const std::span<const point> points = decoder.decode(input, out);
      ASSERT_EQ(points.size(), packet.samples.size());
      for (std::size_t i = 0; i < points.size(); ++i) {
        const double first_deg = packet.first / 64.0 + 5.0 / 64.0 / 39.0 * static_cast<double>(i);
        const auto wanted = reference::point_of(how, first_deg, packet.samples[i]);
        ASSERT_TRUE(points[i].angle_deg >= 0.0F && points[i].angle_deg < 360.0F)
            << points[i].angle_deg;
        ASSERT_LT(reference::apart_deg(static_cast<double>(points[i].angle_deg), wanted.angle_deg),
                  1e-4);
      }
    }
  }
}

TEST_P(SampleLayout, InstructionSetsGiveTheSameBits) {
  const wire_format& how = GetParam();
  const model& which = *model_named(how.model);
  // 24 and 16 bytes without padding.
  const auto same = [](const auto& a, const auto& b) {
    return std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
  };
  check_cases(1000, [&] {
    random_packet packet = any_packet(how);
    if (*rc::gen::arbitrary<bool>()) {  // without returns that are nearer than 300 mm
      for (wire_sample& each : packet.samples) each.word = 0x1000 | (each.word * 40503U & 0xFFFFU);
      const unsigned ct = packet.samples.size() == 1 ? 1 : 0;
      packet.data = reference::packet_of(how, ct, packet.first, packet.last, packet.samples);
    }
    std::array<bulk_decoder, 4> decoders{
        bulk_decoder(which, instruction_set::portable), bulk_decoder(which),
        bulk_decoder(which, instruction_set::portable), bulk_decoder(which)};
    std::array<std::array<point, max_samples>, 2> points{};
    std::array<std::array<xy_point, max_samples>, 2> places{};
    for (std::size_t i = 0; i < 2; ++i) {
      bytes input(packet.data);
      const auto written = decoders[i].decode(input, points[i]);
      RC_ASSERT(written.size() == packet.samples.size());
      std::ranges::fill(std::span(points[i]).subspan(written.size()), point{});
      input = packet.data;
      const auto placed = decoders[2 + i].decode_xy(input, frame::robot, places[i]);
      RC_ASSERT(placed.size() == packet.samples.size());
      std::ranges::fill(std::span(places[i]).subspan(placed.size()), xy_point{});
    }
    RC_ASSERT(same(std::span(points[0]), std::span(points[1])));
    RC_ASSERT(same(std::span(places[0]), std::span(places[1])));
  });
}

TEST_P(SampleLayout, APacketIsFoundInEveryDivision) {
  const wire_format& how = GetParam();
  check_cases(20, [&] {
    const random_packet packet = any_packet(how);
    for (std::size_t piece = 1; piece <= packet.data.size(); ++piece) {
      stream_parser parser(model_named(how.model)->samples);
      std::size_t packets = 0;
      for (std::size_t from = 0; from < packet.data.size(); from += piece) {
        bytes input =
            bytes(packet.data).subspan(from).first(std::min(piece, packet.data.size() - from));
        while (const auto found = parser.next(input)) {
          const auto* const view = std::get_if<packet_view>(&*found);
          RC_ASSERT(view != nullptr);
          RC_ASSERT(std::ranges::equal(view->data(), packet.data));
          RC_ASSERT(from + piece >= packet.data.size());
          ++packets;
        }
      }
      RC_ASSERT(packets == 1U);
    }
  });
}

TEST_P(SampleLayout, ADamagedPacketIsNoPacket) {
  const wire_format& how = GetParam();
  check_cases(100, [&] {
    random_packet packet = any_packet(how);
    const auto at = *rc::gen::inRange<std::size_t>(0, packet.data.size());
    packet.data[at] ^= static_cast<std::uint8_t>(1U << *rc::gen::inRange(0U, 8U));
    RC_ASSERT(!packet_view::from(packet.data, model_named(how.model)->samples).has_value());
  });
}

// Not with the small numbers of a generator: packets of zeros fit in several sizes.
TEST_P(SampleLayout, ReadAsAnotherSizeItIsSkippedAndCounted) {
  const wire_format& how = GetParam();
  std::mt19937 numbers(5);
  const auto random = [&](unsigned below) { return static_cast<unsigned>(numbers() % below); };
  std::vector<std::uint8_t> data;
  for (int i = 0; i < 200; ++i) {
    std::vector<wire_sample> samples;
    for (int sample = 0; sample < 30; ++sample) {
      samples.push_back({how.sample_bytes == 2 ? 0U : random(256), random(65'536)});
    }
    const auto one = reference::packet_of(how, 0, 6400, 6400 + 640, samples);
    data.insert(data.end(), one.begin(), one.end());
  }
  for (const wire_format& other : reference::wire_formats) {
    if (other.sample_bytes == how.sample_bytes) continue;
    SCOPED_TRACE(other.model);
    bulk_decoder decoder(*model_named(other.model));
    std::vector<point> out(20'000);
    bytes input(data);
    std::size_t points = decoder.decode(input, out).size();
    points += decoder.finish(out).size();
    const stream_counts& counts = decoder.counts();
    EXPECT_LT(counts.packets, 20U);  // the exclusive or of two packets fits, too
    EXPECT_LE(points, counts.packets * 80);
    EXPECT_GT(counts.skipped_bytes(), data.size() * 9 / 10);
    EXPECT_EQ(counts.parsed_bytes + counts.skipped_bytes() + decoder.held(), data.size());
  }
}

INSTANTIATE_TEST_SUITE_P(OfTheFamily, SampleLayout, testing::ValuesIn(reference::wire_formats),
                         [](const auto& each) {
                           std::string name = each.param.model;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace g4lidar
