// SPDX-License-Identifier: MIT
// Bytes of a G4 on standard input, points on standard output: the program in the README.
#include <array>
#include <cstdio>
#include <g4lidar/decode.hpp>
#include <g4lidar/stream_parser.hpp>

int main() {
  g4lidar::stream_parser parser;
  std::array<std::uint8_t, 4096> buffer;
  std::array<g4lidar::point, g4lidar::max_samples> points;
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), stdin)) {
    parser.feed({buffer.data(), n}, [&](const g4lidar::event& found) {
      const auto* packet = std::get_if<g4lidar::packet_view>(&found);
      if (packet == nullptr) return;
      for (const auto& p : decode(*packet, g4lidar::compact_correction{}, 0, points).points) {
        std::printf("%.3f degrees %.2f mm\n", static_cast<double>(p.angle_deg),
                    static_cast<double>(p.range_mm));
      }
    });
  }
}
