// SPDX-License-Identifier: MIT
#include "sim/exact.hpp"

#include "transmitter.hpp"

namespace g4lidar::sim {

void transmitter::measure(const motor& head, motor_direction direction) noexcept {
  const bool jolts =
      faults_.strike(fault_kind::jolt) != nullptr && direction == motor_direction::clockwise;
  samples.measure(head, jolts, options_);
}

void transmitter::send_packet(std::int64_t now_ns) noexcept {
  transmission* const packet = samples.take(now_ns);
  if (packet == nullptr) return;
  if (const auto clock = samples.take_time_packet(now_ns, options_.time_packet_ns)) {
    line.send(*clock, now_ns);
  }
  if (faults_.strike(fault_kind::omit) != nullptr) return;
  if (faults_.strike(fault_kind::truncate) != nullptr) {
    const auto most = static_cast<std::uint64_t>(packet->size - packet->begin - 1);
    const std::uint64_t stays = 1 + faults_.draw(fault_kind::truncate, most);
    packet->size = static_cast<std::uint8_t>(packet->begin + stays);
    packet->damaged = true;
  }
  line.send(*packet, now_ns);
}

void transmitter::send(const answer_bytes& what, bool is_scanning, std::int64_t now_ns) noexcept {
  if (!is_scanning || options_.while_scanning == disturbance::between) {
    return line.send(what.view(), now_ns);
  }
  if (options_.while_scanning == disturbance::drops) line.cut_front();
  line.interject(what, now_ns);
}

void transmitter::byte_sent(bridge& to_host, std::int64_t now_ns) noexcept {
  const passed_byte passing = faults_.pass(line.byte());
  bool lost = false;
  for (std::uint8_t i = 0; i < passing.count; ++i) {
    lost = !to_host.take(passing.bytes[i], faults_, now_ns) || lost;
  }
  const bool parted = passing.inserted && line.inside_packet();
  if (line.in_packet() && (passing.damaged || lost || parted)) line.damage();
  if (const transmission* const done = line.ending(); done != nullptr && done->count > 0) {
    truths.add(*done, !done->damaged, now_ns);
  }
  line.advance();
}

}  // namespace g4lidar::sim
