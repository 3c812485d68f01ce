// SPDX-License-Identifier: MIT
// Raw bytes as points: packets with wrong angles.
#include "export/byte_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "g4lidar/sim/scanner.hpp"
#include "support/packet_maker.hpp"

namespace g4lidar::test {
namespace {

using namespace g4_tool;

/// The ranges of the points that are flagged unlikely.
class unlikely_ranges final : public point_writer {
 public:
  [[nodiscard]] bool takes_scans() const noexcept override { return false; }
  void write_points(std::span<const point> points, text_sink&) override {
    for (const point& p : points) {
      if ((p.flags & point_flags::unlikely) != point_flags::none) ranges_mm.push_back(p.range_mm);
    }
  }
  std::vector<float> ranges_mm;
};

// Of two other packets in turn the first half is lost.
TEST(BytePoints, OnlyAPacketWithWrongAnglesIsUnlikely) {
  sim::scanner scanner(sim::built_in_world(), {});
  std::vector<std::uint8_t> raw;
  std::vector<float> expected;
  for (int i = 0; i < 400; ++i) {
    const sim::sent_packet packet = scanner.next();
    bytes data = packet.data;
    const packet_view view = *packet_view::from(data);
    made::packet turned(view.ct(), (view.first_angle_64ths() + 640) % turn_64ths,
                        (view.last_angle_64ths() + 640) % turn_64ths, view.sample_count());
    for (std::size_t k = 0; k < view.sample_count(); ++k) {
      turned.set(k, view.sample(k));
      if (i == 200) expected.push_back(static_cast<float>(view.sample(k)) * 0.25F);
    }
    if (i == 200) data = turned.data();
    if (i == 220 || i == 221) data = data.last(data.size() / 2);
    raw.insert(raw.end(), data.begin(), data.end());
  }
  ASSERT_EQ(expected.size(), 40U);
  unlikely_ranges converted;
  callback_sink nowhere([](std::string_view) {});
  byte_points points(converted, nowhere, 9000);
  for (bytes rest = raw; !rest.empty();) {
    const std::size_t count = std::min<std::size_t>(rest.size(), 61);
    points.take(rest.first(count));
    rest = rest.subspan(count);
  }
  points.finish();
  EXPECT_EQ(converted.ranges_mm, expected);
}

}  // namespace
}  // namespace g4lidar::test
