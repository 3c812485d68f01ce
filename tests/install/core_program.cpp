// SPDX-License-Identifier: MIT
// A consumer of g4lidar::core. Exit code 0 if a packet gives its point.
#include <array>
#include <cstdint>
#include <variant>

#include "g4lidar/core/decode.hpp"
#include "g4lidar/core/stream_parser.hpp"

int main() {
  // One sample of 1000 mm at 90 degrees.
  std::array<std::uint8_t, 12> bytes{0xAA, 0x55, 0x00, 0x01, 0x01, 0x2D,
                                     0x01, 0x2D, 0x00, 0x00, 0xA0, 0x0F};
  g4lidar::store_u16(bytes, 8, g4lidar::packet_checksum(bytes));

  std::array<g4lidar::point, g4lidar::max_samples> points{};
  std::size_t count = 0;
  g4lidar::stream_parser parser;
  parser.feed(bytes, [&](const g4lidar::event& found) {
    if (const auto* packet = std::get_if<g4lidar::packet_view>(&found)) {
      count += g4lidar::decode(*packet, g4lidar::compact_correction{}, 0, points).points.size();
    }
  });
  const bool right = count == 1 && points[0].range_mm == 1000.0F && points[0].angle_deg > 82.0F &&
                     points[0].angle_deg < 90.0F;
  return right ? 0 : 1;
}
