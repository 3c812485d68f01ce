// SPDX-License-Identifier: MIT
// A session that communicates with the simulated device, in virtual time.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "g4lidar/core/session.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/sim/device.hpp"

namespace g4lidar::test {

/// A session, a parser and a simulated device, and the loop of a driver between them.
class on_simulator {
 public:
  explicit on_simulator(const sim::device_options& options = {},
                        std::span<const sim::fault> faults = {}, const session_times& times = {})
      : device(sim::built_in_world(), options, faults), talk(times) {}

  /// Begins a request and runs until it has ended; nothing if it was refused or never ends.
  std::optional<outcome> ask(const request& wanted, while_scanning how = while_scanning::refuse) {
    if (talk.begin(wanted, now_ns, how)) return std::nullopt;
    const std::int64_t until = now_ns + 60'000'000'000;
    while (now_ns < until) {
      if (const auto done = talk.finished()) return done;
      step(until);
    }
    return std::nullopt;
  }

  /// Runs for `ns`.
  void run_for(std::int64_t ns) {
    const std::int64_t until = now_ns + ns;
    while (now_ns < until) step(until);
  }

  sim::device device;
  session talk;
  std::int64_t now_ns = 10'000'000'000;
  std::uint64_t packets = 0;
  std::vector<notice> reported;

 private:
  static constexpr std::int64_t pause_ns =
      30'000'000;  // after this, half a packet is not continued

  void step(std::int64_t until) {
    while (const auto command = talk.to_send()) device.write(*command, now_ns);
    if (const notice news = talk.noticed(); news != notice::none) reported.push_back(news);
    std::int64_t next = std::min(until, talk.next_look_ns());
    if (parser_.held() > 0) next = std::min(next, heard_ns_ + pause_ns);
    next = std::min(next, device.next_ns(now_ns));
    now_ns = std::max(now_ns + 1, next);
    read();
    if (now_ns >= talk.next_look_ns()) talk.look(now_ns);
  }

  void read() {
    std::array<std::uint8_t, 512> room{};
    while (const std::size_t count = device.read(room, now_ns)) {
      heard_ns_ = now_ns;
      bytes input(room.data(), count);
      while (const auto found = parser_.next(input)) show(*found);
    }
    if (now_ns < heard_ns_ + pause_ns) return;
    while (const auto found = parser_.finish()) show(*found);
  }

  void show(const event& found) {
    if (std::get_if<packet_view>(&found) != nullptr) ++packets;
    talk.take(found, now_ns);
  }

  stream_parser parser_;
  std::int64_t heard_ns_ = 0;
};

}  // namespace g4lidar::test
