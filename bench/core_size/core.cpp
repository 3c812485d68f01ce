// SPDX-License-Identifier: MIT
// The parser, decode and the ring as in the firmware of a microcontroller, to measure their size.
#include <cstddef>
#include <cstdint>
#include <variant>

#include "g4lidar/core/correction.hpp"
#include "g4lidar/core/decode.hpp"
#include "g4lidar/core/point_ring.hpp"
#include "g4lidar/core/stream_parser.hpp"

namespace {

constexpr std::size_t points_in_ring = 512;

g4lidar::stream_parser parser;
g4lidar::revolution_counter revolutions;
g4lidar::point_ring<points_in_ring> ring;

}  // namespace

/// From the interrupt of the UART: some bytes into the ring.
extern "C" void take_bytes(const std::uint8_t* data, std::size_t count) {
  std::array<g4lidar::point, g4lidar::max_samples> points;
  g4lidar::bytes input(data, count);
  while (const auto found = parser.next(input)) {
    if (const auto* packet = std::get_if<g4lidar::packet_view>(&*found)) {
      ring.push(g4lidar::decode(*packet, g4lidar::compact_correction{}, revolutions.count(*packet),
                                points)
                    .points);
    }
  }
}

/// From the main loop: points out of the ring.
extern "C" std::size_t take_points(g4lidar::point* out, std::size_t room) {
  static auto reader = ring.make_reader();
  return reader.read({out, room}).points;
}

// bench/core_size.sh reads the symbols of the object: bytes of state.
extern "C" {
extern const std::uint8_t size_of_parser[sizeof(parser)];
extern const std::uint8_t size_of_carry[g4lidar::max_packet_size];
extern const std::uint8_t size_of_ring[sizeof(ring)];
const std::uint8_t size_of_parser[sizeof(parser)] = {};
const std::uint8_t size_of_carry[g4lidar::max_packet_size] = {};
const std::uint8_t size_of_ring[sizeof(ring)] = {};
}
