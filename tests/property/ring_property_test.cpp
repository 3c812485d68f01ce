// SPDX-License-Identifier: MIT
// The ring and a model that keeps every point ever written: any order of pushes and reads.
#include <gtest/gtest.h>
// GoogleTest first.
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "g4lidar/core/point_ring.hpp"
#include "support/check_cases.hpp"

namespace g4lidar {
namespace {

constexpr std::size_t capacity = 16;

/// What a reader of a ring must return: everything written and no older than `capacity`, in order.
struct model {
  std::vector<point> written;

  struct answer {
    std::uint64_t missed;
    std::vector<point> points;
  };
  [[nodiscard]] answer read(std::size_t& place, std::size_t room) const {
    const std::size_t oldest = written.size() > capacity ? written.size() - capacity : 0;
    const std::size_t from = std::max(place, oldest);
    const std::size_t count = std::min(room, written.size() - from);
    const auto begin = written.begin() + static_cast<std::ptrdiff_t>(from);
    answer result{from - place, {begin, begin + static_cast<std::ptrdiff_t>(count)}};
    place = from + count;
    return result;
  }
};

template <class Word>
void behaves_like_the_model(std::uint64_t first,
                            const std::vector<std::pair<std::uint8_t, std::uint8_t>>& steps) {
  using ring = point_ring<capacity, Word>;
  const auto real = std::make_unique<ring>(first);
  model ideal;
  std::vector<std::pair<typename ring::reader, std::size_t>>
      readers;  // with its position in the model
  for (const auto& [what, size] : steps) {
    switch (what % 4) {
      case 0: {  // many points, sometimes more than the ring holds
        std::vector<point> points(size % 50);
        for (point& p : points)
          p.time_ns = static_cast<std::int64_t>(ideal.written.size() + 1 +
                                                static_cast<std::size_t>(&p - points.data()));
        real->push(points);
        ideal.written.insert(ideal.written.end(), points.begin(), points.end());
        break;
      }
      case 1: {
        point p;
        p.revolution = size;
        real->push(p);
        ideal.written.push_back(p);
        break;
      }
      case 2:
        readers.emplace_back(real->make_reader(), ideal.written.size());
        break;
      default:
        for (auto& [reader, place] : readers) {
          std::vector<point> out(size % 24);
          const ring_read got = reader.read(out);
          const model::answer expected = ideal.read(place, out.size());
          out.resize(got.points);
          RC_ASSERT(got.missed == expected.missed);
          RC_ASSERT(out == expected.points);
          RC_ASSERT(reader.ahead() == ideal.written.size() - place);
        }
    }
    RC_ASSERT(real->written() == first + ideal.written.size());
  }
}

using steps_of = std::vector<std::pair<std::uint8_t, std::uint8_t>>;

/// Numbers shortly before a carry of a counter, and any others.
rc::Gen<std::uint64_t> first_numbers() {
  return rc::gen::oneOf(
      rc::gen::arbitrary<std::uint64_t>(), rc::gen::just(std::uint64_t{0}),
      rc::gen::map(rc::gen::inRange<std::uint64_t>(0, 200), [](std::uint64_t n) { return 0 - n; }),
      rc::gen::map(rc::gen::inRange<std::uint64_t>(0, 200),
                   [](std::uint64_t n) { return (std::uint64_t{1} << 32) - n; }));
}

TEST(RingProperty, BehavesLikeTheModelInWordsOf64Bits) {
  test::check_cases(2000, [](const steps_of& steps) {
    behaves_like_the_model<std::uint64_t>(*first_numbers(), steps);
  });
}

TEST(RingProperty, BehavesLikeTheModelInWordsOf32Bits) {
  test::check_cases(2000, [](const steps_of& steps) {
    behaves_like_the_model<std::uint32_t>(*first_numbers(), steps);
  });
}

}  // namespace
}  // namespace g4lidar
