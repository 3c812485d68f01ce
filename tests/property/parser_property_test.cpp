// SPDX-License-Identifier: MIT
// The parser and the reference on random streams, intact and damaged, for every division.
#include <gtest/gtest.h>
// GoogleTest first.
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "g4lidar/core/stream_parser.hpp"
#include "support/check_cases.hpp"
#include "support/random_stream.hpp"
#include "support/reference_parser.hpp"
#include "support/stream_log.hpp"

namespace g4lidar {
namespace {

using test::buffer;
using test::check_cases;
using test::random_stream;
using test::recipe;

rc::Gen<std::vector<recipe>> recipes(std::uint8_t kinds) {
  return rc::gen::container<std::vector<recipe>>(
      rc::gen::pair(rc::gen::inRange<std::uint8_t>(0, kinds),
                    rc::gen::resize(rc::kNominalSize, rc::gen::arbitrary<std::uint64_t>())));
}

random_stream any_stream(double length = 1.0) {
  random_stream stream;
  const auto parts = *rc::gen::scale(length, recipes(test::part_kinds));
  const auto harms = *rc::gen::scale(0.3 * length, recipes(test::damage_kinds));
  for (const recipe& part : parts) stream.add(part);
  for (const recipe& harm : harms) stream.damage(harm);
  return stream;
}

/// Sizes of pieces, used in turn and repeatedly; mostly small.
std::vector<std::size_t> any_cuts() {
  auto cuts = *rc::gen::container<std::vector<std::size_t>>(
      rc::gen::oneOf(rc::gen::inRange<std::size_t>(0, 5), rc::gen::inRange<std::size_t>(1, 40),
                     rc::gen::inRange<std::size_t>(1, 400)));
  cuts.push_back(1 + cuts.size());  // at least one that is not 0
  return cuts;
}

/// The first error of `parser` with `data`; empty if there is none.
std::string complaint_of(stream_parser& parser, const buffer& data,
                         const std::vector<std::size_t>& cuts, const reference::reading& wanted) {
  test::stream_log log(data);
  std::size_t from = 0;
  for (std::size_t i = 0; from < data.size(); ++i) {
    const std::size_t count = std::min(cuts[i % cuts.size()], data.size() - from);
    log.feed(parser, count);
    from += count;
  }
  log.finish(parser);
  return test::difference(log, wanted);
}

TEST(ParserProperty, AgreesWithTheReferenceForEveryDivision) {
  check_cases(800, [] {
    const buffer data = any_stream().data();
    const reference::reading wanted = reference::read(data);
    stream_parser parser;  // one for all: finish() resets it
    RC_ASSERT(complaint_of(parser, data, {data.size() + 1}, wanted) == "");
    RC_ASSERT(complaint_of(parser, data, {1}, wanted) == "");
    for (int i = 0; i < 4; ++i) {
      const auto cuts = any_cuts();
      RC_ASSERT(complaint_of(parser, data, cuts, wanted) == "");
    }
  });
}

TEST(ParserProperty, EveryDivisionInTwo) {
  check_cases(80, [] {
    const buffer data = any_stream(0.15).data();
    const reference::reading wanted = reference::read(data);
    for (std::size_t first = 1; first < data.size(); ++first) {
      stream_parser parser;
      RC_ASSERT(complaint_of(parser, data, {first, data.size()}, wanted) == "");
    }
  });
}

TEST(ParserProperty, DeliversUndamagedPackets) {
  std::size_t intact = 0;
  std::size_t overlapped = 0;
  check_cases(1500, [&] {
    const random_stream stream = any_stream();
    const buffer data = stream.data();
    const reference::reading wanted = reference::read(data);
    stream_parser parser;
    test::stream_log log(data);
    log.feed(parser, data.size());
    log.finish(parser);
    RC_ASSERT(test::difference(log, wanted) == "");
    for (const test::intact_unit& unit : stream.intact_units()) {
      ++intact;
      // The stretch that contains the unit's first byte: the unit itself, or an earlier valid
      // one.
      const auto holder = std::find_if(
          log.stretches().begin(), log.stretches().end(),
          [&](const reference::stretch& s) { return s.offset + s.size > unit.offset; });
      RC_ASSERT(holder != log.stretches().end());
      RC_ASSERT(holder->what <= reference::kind::time_packet);
      if (holder->offset == unit.offset) {
        RC_ASSERT(holder->size == unit.size);
      } else {
        RC_ASSERT(reference::start_at(data, holder->offset).state == reference::start::valid);
        ++overlapped;
      }
    }
  });
  RecordProperty("intact", std::to_string(intact));
  RecordProperty("overlapped", std::to_string(overlapped));
  std::cout << intact << " untouched units, " << overlapped
            << " of them overlapped by an earlier valid one\n";
  EXPECT_GT(intact, 1000U);
  EXPECT_GT(overlapped, 0U) << "the generator makes none: the exception is not tested";
  EXPECT_LT(overlapped, intact / 10);
}

TEST(ParserProperty, MoreBytes_ChangeOnlyIncompleteResults) {
  check_cases(200, [] {
    const buffer data = any_stream().data();
    for (std::size_t from = 0; from < data.size(); ++from) {
      if (data[from] != 0xAA && data[from] != 0xA5) continue;
      const bytes all = bytes(data).subspan(from);
      const std::size_t most = std::min<std::size_t>(all.size(), max_packet_size + 3);
      const front last = what_stands_at_front(all);
      std::size_t announced = 1;
      for (std::size_t have = 1; have <= most; ++have) {
        const front now = what_stands_at_front(all.first(have));
        if (now.kind != front_kind::incomplete) {
          // Only further noise behind noise makes a result longer.
          const bool is_noise = now.kind == front_kind::skip && now.reason == skip_reason::noise;
          const bool same_noise = is_noise && last.kind == now.kind && last.reason == now.reason &&
                                  last.size >= now.size;
          const bool unchanged = now == last || same_noise;
          RC_ASSERT(unchanged);
          RC_ASSERT(have >= announced);
          break;
        }
        RC_ASSERT(now.size > have);
        RC_ASSERT(now.size >= announced);
        announced = now.size;
      }
    }
  });
}

}  // namespace
}  // namespace g4lidar
