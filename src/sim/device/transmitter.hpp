// SPDX-License-Identifier: MIT
// What a simulated lidar sends: the packets that its head measures, and its answers between them.
#pragma once

#include <cstdint>

#include "bridge.hpp"
#include "fault_injector.hpp"
#include "g4lidar/sim/device_options.hpp"
#include "line_receiver.hpp"
#include "motor.hpp"
#include "sampler.hpp"
#include "truth_log.hpp"
#include "wire.hpp"

namespace g4lidar::sim {

class transmitter {
 public:
  /// Options and faults must outlive it.
  transmitter(const world& scene, const device_options& options, fault_injector& faults)
      : samples(scene, scanner_of(options)),
        line(options.baud),
        of_host(stream_for(options.scanner.seed, purpose::line_to_host)),
        truths(options.truth_capacity),
        options_(options),
        faults_(faults) {}

  /// Measures the next packet.
  void measure(const motor& head, motor_direction direction) noexcept;
  /// The packet that was measured is complete: it is sent, or a fault changes that.
  void send_packet(std::int64_t now_ns) noexcept;
  /// Sends an answer; during a scan as the options state.
  void send(const answer_bytes& answer, bool is_scanning, std::int64_t now_ns) noexcept;
  /// A byte has been sent: the bridge, at the rate of the host, receives it, and the next one follows.
  void byte_sent(bridge& to_host, std::uint32_t host_baud, std::int64_t now_ns) noexcept;
  /// When a host at another rate receives another byte although nothing is sent any more.
  [[nodiscard]] std::int64_t rest_ns() const noexcept {
    return line.is_silent() ? of_host.due_ns() : forever_ns;
  }
  /// It receives it.
  void rest(bridge& to_host, std::int64_t now_ns) noexcept;

  sampler samples;
  wire line;
  line_receiver of_host;
  truth_log truths;

 private:
  const device_options& options_;
  fault_injector& faults_;
};

}  // namespace g4lidar::sim
