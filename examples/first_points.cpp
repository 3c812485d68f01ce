// SPDX-License-Identifier: MIT
// Bytes of a G4 on standard input, points on standard output.
#include <array>
#include <cstdio>
#include <g4lidar/recording/bulk_decoder.hpp>

int main() {
  g4lidar::bulk_decoder decoder;
  std::array<std::uint8_t, 4096> buffer;
  std::array<g4lidar::point, 4096> points;  // a point takes at least two bytes
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), stdin)) {
    g4lidar::bytes input(buffer.data(), n);
    for (const g4lidar::point& p : decoder.decode(input, points)) {
      if (p.is_no_return() || p.is_too_near()) continue;  // not reliable
      std::printf("%.3f degrees %.2f mm\n", static_cast<double>(p.angle_deg),
                  static_cast<double>(p.range_mm));
    }
  }
  return std::ferror(stdin) != 0 ? 1 : 0;
}
