// SPDX-License-Identifier: MIT
// The rotating head of a simulated lidar with its scanner: the packet that is being measured.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "g4lidar/sim/device_options.hpp"
#include "g4lidar/sim/scanner.hpp"
#include "motor.hpp"
#include "sim/purpose.hpp"
#include "wire.hpp"

namespace g4lidar::sim {

class sampler {
 public:
  sampler(const world& scene, const scanner_options& options)
      : scanner_(scene, options),
        phases_(stream_for(options.seed, purpose::phases)),
        strays_(stream_for(options.seed, purpose::strays)) {}

  void set(sample_rate rate, turning direction) noexcept {
    scanner_.set_sample_rate(rate);
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
  /// clockwise, moves back during the packet. `options` select the byte before a zero packet.
  void measure(const motor& head, bool jolts, const device_options& options) noexcept {
    scanner_.set_speed_mhz(head.speed_mhz(scanner_.next_sample_ns()));
    if (jolts) scanner_.set_turning(turning::falling);
    const sent_packet packet = scanner_.next();
    if (jolts) scanner_.set_turning(turning::clockwise);
    std::optional<std::uint8_t> stray;
    if (options.stray_before_zero && (packet.data[2] & 1U) != 0) {
      stray = options.ct_crc ? packet.crc : static_cast<std::uint8_t>(strays_.next() >> 56);
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
  /// The time packet that precedes the complete packet, if one is due; see device_options.
  [[nodiscard]] std::optional<std::array<std::uint8_t, 8>> take_time_packet(
      std::int64_t now_ns, std::int64_t interval_ns) noexcept {
    if (interval_ns == 0 || now_ns < clock_due_ns_) return std::nullopt;
    clock_due_ns_ = now_ns + interval_ns;
    const std::int64_t ms = now_ns / 1'000'000;
    std::array<std::uint8_t, 8> made{0xAA, 0x66};
    for (std::size_t i = 0; i < 4; ++i) made[3 + i] = static_cast<std::uint8_t>(ms >> 8 * i & 0xFF);
    made[2] = made[0] ^ made[1] ^ made[3] ^ made[4] ^ made[5] ^ made[6] ^ made[7];
    return made;
  }

 private:
  scanner scanner_;
  random_stream phases_;
  random_stream strays_;
  transmission measured_;
  std::uint64_t packets_ = 0;  // sent ones
  std::int64_t clock_due_ns_ = 0;
  std::int64_t complete_ns_ = forever_ns;
  std::int64_t silent_until_ns_ = 0;
  std::int64_t end_ns_ = forever_ns;
};

}  // namespace g4lidar::sim
