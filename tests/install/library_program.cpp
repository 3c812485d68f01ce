// SPDX-License-Identifier: MIT
// A consumer of g4lidar::g4lidar. Exit code 0 if a packet gives its point.
#include <array>
#include <cstdint>

#include "g4lidar/recording/bulk_decoder.hpp"

int main() {
  // One sample of 1000 mm at 90 degrees.
  std::array<std::uint8_t, 12> packet{0xAA, 0x55, 0x00, 0x01, 0x01, 0x2D,
                                      0x01, 0x2D, 0x00, 0x00, 0xA0, 0x0F};
  g4lidar::store_u16(packet, 8, g4lidar::packet_checksum(packet));

  std::array<g4lidar::point, g4lidar::max_samples> points{};
  g4lidar::bulk_decoder decoder;
  g4lidar::bytes input = packet;
  const auto written = decoder.decode(input, points);
  return written.size() == 1 && written[0].range_mm == 1000.0F ? 0 : 1;
}
