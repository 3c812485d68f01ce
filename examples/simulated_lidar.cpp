// SPDX-License-Identifier: MIT
// A test of a program without a lidar: does it detect that a G4 was unplugged and plugged in again?
// The simulated one runs in virtual time, so that 10 seconds take a few milliseconds.
#include <array>
#include <cstdio>
#include <g4lidar/core/command.hpp>
#include <g4lidar/core/stream_parser.hpp>
#include <g4lidar/sim/virtual_port.hpp>

namespace {

// Reads until `deadline_ns` or until the port is gone; returns the number of packets.
std::size_t packets_until(g4lidar::transport& port, std::int64_t deadline_ns) {
  g4lidar::stream_parser parser;
  std::array<std::uint8_t, 4096> buffer;
  std::size_t packets = 0;
  while (port.now_ns() < deadline_ns) {
    const auto got = port.read(buffer, deadline_ns);
    if (!got) {
      std::printf("%s\n", got.error().message().c_str());
      break;
    }
    parser.feed({buffer.data(), got->count}, [&](const g4lidar::event& found) {
      if (std::holds_alternative<g4lidar::packet_view>(found)) ++packets;
    });
  }
  return packets;
}

}  // namespace

int main() {
  constexpr std::int64_t second = 1'000'000'000;
  constexpr std::array<std::uint8_t, 2> start = g4lidar::encode(g4lidar::command::start);
  // Unplugged after 5 s, plugged in again 2 s later; one bit is inverted in one of 10,000 bytes.
  const std::array faults{
      g4lidar::sim::make_fault(g4lidar::sim::fault_kind::unplug, 5 * second, 2 * second),
      std::get<g4lidar::sim::fault>(g4lidar::sim::parse_fault("flip*0.01%"))};
  g4lidar::sim::device simulated(g4lidar::sim::built_in_world(), {}, faults);
  g4lidar::sim::virtual_clock clock;
  g4lidar::sim::virtual_connector finder(simulated, clock);

  std::size_t packets = 0;
  while (clock.now_ns() < 10 * second) {
    const auto port = finder.connect();
    if (!port) {
      if (!finder.pause(clock.now_ns() + second / 2)) return 1;
      continue;
    }
    // A device that has just been plugged in is still booting: send until it answers.
    while (!simulated.is_scanning() && (*port)->write(start, 10 * second)) {
      if (!(*port)->pause(clock.now_ns() + second / 10)) break;
    }
    packets += packets_until(**port, 10 * second);
  }
  std::printf("%zu packets in %.1f s, connected %llu times\n", packets,
              static_cast<double>(clock.now_ns()) / 1e9,
              static_cast<unsigned long long>(simulated.replugs() + 1));
  return packets > 1'500 && simulated.replugs() == 1 ? 0 : 1;
}
