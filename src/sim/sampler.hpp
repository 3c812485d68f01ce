// SPDX-License-Identifier: MIT
// The rotating head of a simulated G4 with its scanner: the packet that is being measured.
#pragma once

#include <cstdint>
#include <optional>

#include "g4lidar/sim/scanner.hpp"
#include "motor.hpp"
#include "purpose.hpp"
#include "wire.hpp"

namespace g4lidar::sim {

class sampler {
 public:
  sampler(const world& scene, const scanner_options& options)
      : scanner_(scene, options),
        phases_(stream_for(options.seed, purpose::phases)),
        strays_(stream_for(options.seed, purpose::strays)) {}

  void set(ranging_frequency ranging, turning direction) noexcept {
    scanner_.set_ranging(ranging);
    scanner_.set_turning(direction);
  }
  /// A scan begins at a random angle.
  void begin(std::int64_t now_ns) noexcept { scanner_.resume(now_ns, phases_.next()); }
  void end() noexcept { complete_ns_ = end_ns_ = forever_ns; }
  /// The scan is to be ended at this time; forever_ns: it is not.
  void end_at(std::int64_t time_ns) noexcept { end_ns_ = time_ns; }
  [[nodiscard]] std::int64_t end_ns() const noexcept { return end_ns_; }
  /// No packet is sent before this time.
  void silence_until(std::int64_t time_ns) noexcept { silent_until_ns_ = time_ns; }

  [[nodiscard]] bool is_silent(std::int64_t now_ns) const noexcept {
    return now_ns < silent_until_ns_;
  }

  /// Measures the next packet: its content when it is complete. `jolts`: the head, which turns
  /// clockwise, moves back during the packet. `has_stray`: a random byte precedes a zero packet.
  void measure(const motor& head, bool jolts, bool has_stray) noexcept {
    scanner_.set_speed_mhz(head.speed_mhz(scanner_.next_sample_ns()));
    if (jolts) scanner_.set_turning(turning::falling);
    const sent_packet packet = scanner_.next();
    if (jolts) scanner_.set_turning(turning::clockwise);
    std::optional<std::uint8_t> stray;
    if (has_stray && (packet.data[2] & 1U) != 0) {
      stray = static_cast<std::uint8_t>(strays_.next() >> 56);
    }
    measured_.assign(packet, stray);
    complete_ns_ = packet.complete_ns;
  }
  /// When the packet is complete.
  [[nodiscard]] std::int64_t next_ns() const noexcept { return complete_ns_; }
  /// The complete packet; nullptr if it is not sent. Valid until measure().
  [[nodiscard]] transmission* take(std::int64_t now_ns) noexcept {
    if (is_silent(now_ns)) return nullptr;
    measured_.packet = packets_++;
    return &measured_;
  }

 private:
  scanner scanner_;
  random_stream phases_;
  random_stream strays_;
  transmission measured_;
  std::uint64_t packets_ = 0;  // sent ones
  std::int64_t complete_ns_ = forever_ns;
  std::int64_t silent_until_ns_ = 0;
  std::int64_t end_ns_ = forever_ns;
};

}  // namespace g4lidar::sim
