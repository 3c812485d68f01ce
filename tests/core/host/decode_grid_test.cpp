// SPDX-License-Identifier: MIT
// Every sample value, at some hundred directions, compared with the reference in double precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "g4lidar/core/correction.hpp"
#include "g4lidar/core/decode.hpp"
#include "support/packet_maker.hpp"
#include "support/reference_points.hpp"
#include "support/test_scale.hpp"

namespace g4lidar {
namespace {

/// First and last first-level angle of a packet, 1/64 degree.
struct arc {
  int first, last;
};

/// Arcs around the whole circle, with lengths that make angles between the steps of the protocol;
/// many on both sides of zero and where the largest corrections cross it.
std::vector<arc> arcs() {
  std::vector<arc> all;
  const auto add = [&](int first, int length) {
    const int last = (first + length) % 23040;
    if (last >= first || (first > 270 * 64 && last < 90 * 64)) all.push_back({first, last});
  };
  const int step = 23040 / (150 * test::test_scale());
  for (int first = 0, length = 1; first < 23040; first += step) {
    add(first, length);
    length = (length * 7 + 3) % 2500;
  }
  for (int near_zero = -100 * 64; near_zero <= 10 * 64; near_zero += 60) {
    add((near_zero + 23040) % 23040, 79);
  }
  for (const int first : {0, 1, 510, 511, 512, 22528, 23039}) {
    for (const int length : {0, 1, 39, 1260}) add(first, length);
  }
  return all;
}

/// The reference's correction of every sample, computed once.
const std::vector<double>& corrections() {
  static const std::vector<double> all = [] {
    std::vector<double> made;
    for (unsigned raw = 0; raw <= 65535; ++raw) {
      made.push_back(reference::correction_deg(static_cast<std::uint16_t>(raw)));
    }
    return made;
  }();
  return all;
}

template <class Form>
double worst_error(const Form& form, const arc& over, bool& in_range) {
  const double first = over.first / 64.0;
  const double way = (over.last - over.first + (over.last < over.first ? 23040 : 0)) / 64.0;
  double worst = 0.0;
  std::vector<std::uint16_t> raw(80);
  std::array<point, max_samples> out;
  // Packets of 77 to 80 samples, so that each sample is at different positions in its packet.
  for (unsigned next = 0; next <= 65535; next += static_cast<unsigned>(raw.size())) {
    raw.resize(std::min<std::size_t>(77 + next / 7 % 4, 65536 - next));
    for (std::size_t i = 0; i < raw.size(); ++i) {
      raw[i] = static_cast<std::uint16_t>((next + i) * 40503U);  // all of them, mixed
    }
    const made::packet packet(0, over.first, over.last, raw);
    const decoded got = decode(packet.view(), form, 0, out);
    if (got.points.size() != raw.size()) return 360.0;
    const double step = raw.size() > 1 ? way / static_cast<double>(raw.size() - 1) : 0.0;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      const point& p = got.points[i];
      const double expected = first + step * static_cast<double>(i) + corrections()[raw[i]];
      const double off = std::fabs(static_cast<double>(p.angle_deg) - expected);
      worst = std::max(worst, std::min(off, std::fabs(off - 360.0)));
      in_range =
          in_range && p.angle_deg >= 0.0F && p.angle_deg < 360.0F &&
          static_cast<double>(p.range_mm) == (reference::is_no_return(raw[i]) ? 0.0 : raw[i] / 4.0);
    }
  }
  return worst;
}

/// Tests every `each`th arc.
template <class Form>
void expect_within(const Form& form, double bound, std::size_t each = 1) {
  const std::vector<arc> over = arcs();
  double worst = 0.0;
  bool in_range = true;
  for (std::size_t i = 0; i < over.size(); i += each) {
    worst = std::max(worst, worst_error(form, over[i], in_range));
  }
  EXPECT_LT(worst, bound);
  EXPECT_TRUE(in_range);
}

TEST(DecodeGrid, CoversSomeHundredDirections) { EXPECT_GE(arcs().size(), 280U); }

// In single precision an angle below 360 is rounded by up to 1.6e-5 degrees. This form is slow.
TEST(DecodeGrid, ExactFormIsRoundedOnly) { expect_within(exact_correction{}, 1.6e-5, 5); }

TEST(DecodeGrid, TableFormIsWithinItsBound) {
  expect_within(*std::make_unique<table_correction>(), 1e-4, 2);
}

TEST(DecodeGrid, CompactFormIsWithinItsBound) { expect_within(compact_correction{}, 1e-4); }

}  // namespace
}  // namespace g4lidar
