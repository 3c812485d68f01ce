// SPDX-License-Identifier: MIT
// The host's side of a simulated G4, in virtual time: sends commands, reads, and keeps the time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "g4lidar/core/command.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/sim/device.hpp"

namespace g4lidar::test {

using byte_vector = std::vector<std::uint8_t>;

inline constexpr std::int64_t ms = 1'000'000;
inline constexpr std::int64_t second = 1'000 * ms;

/// The received bytes, parsed.
struct heard {
  byte_vector bytes;
  std::size_t packets = 0;
  std::size_t zero_packets = 0;
  std::size_t suspect = 0;
  std::size_t skipped_bytes = 0;
  std::size_t samples = 0;
  std::vector<byte_vector> packet_bytes;
  std::vector<response_kind> responses;
};

[[nodiscard]] inline heard taken_apart(byte_vector bytes) {
  heard found;
  found.bytes = std::move(bytes);
  stream_parser parser;
  const auto take = [&](const event& e) {
    if (const auto* packet = std::get_if<packet_view>(&e)) {
      ++found.packets;
      found.samples += packet->sample_count();
      found.zero_packets += packet->is_zero() ? 1U : 0U;
      found.suspect += packet->is_suspect() ? 1U : 0U;
      found.packet_bytes.emplace_back(packet->data().begin(), packet->data().end());
    } else if (const auto* response = std::get_if<response_view>(&e)) {
      found.responses.push_back(response->kind());
    } else {
      found.skipped_bytes += std::get<skipped>(e).count;
    }
  };
  parser.feed(found.bytes, take);
  while (const auto last = parser.finish()) take(*last);
  return found;
}

class host_side {
 public:
  explicit host_side(const sim::device_options& options = {},
                     std::initializer_list<sim::fault> faults = {})
      : device(sim::built_in_world(), options, std::span(faults.begin(), faults.size())) {}

  void send(std::uint8_t code) { device.write(std::array<std::uint8_t, 2>{0xA5, code}, now_ns); }
  void send(command code) { send(static_cast<std::uint8_t>(code)); }

  /// All bytes that arrive within this time.
  byte_vector listen(std::int64_t for_ns) {
    const std::int64_t end_ns = now_ns + for_ns;
    byte_vector all;
    for (;;) {
      std::array<std::uint8_t, 1024> part{};
      const std::size_t count = device.read(part, now_ns);
      all.insert(all.end(), part.begin(), part.begin() + static_cast<std::ptrdiff_t>(count));
      if (count > 0) continue;
      const std::int64_t next = device.next_ns(now_ns);
      if (next > end_ns) break;
      now_ns = next > now_ns ? next : now_ns + 1;
    }
    now_ns = end_ns;
    return all;
  }
  heard hear(std::int64_t for_ns) { return taken_apart(listen(for_ns)); }

  byte_vector ask(std::uint8_t code, std::int64_t for_ns = 50 * ms) {
    send(code);
    return listen(for_ns);
  }
  byte_vector ask(command code, std::int64_t for_ns = 50 * ms) {
    return ask(static_cast<std::uint8_t>(code), for_ns);
  }

  sim::device device;
  std::int64_t now_ns = 0;
};

}  // namespace g4lidar::test
