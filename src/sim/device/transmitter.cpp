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
  if (options_.empty_packets && packet->zero) {
    const bytes zero = bytes(packet->data).subspan(packet->begin);
    // With two equal angles the checksum is that of the start alone.
    line.send(std::array<std::uint8_t, 10>{0xAA, 0x55, 0x00, 0x00, zero[4], zero[5], zero[4],
                                           zero[5], 0xAA, 0x55},
              now_ns);
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

void transmitter::send(const answer_bytes& answer, bool is_scanning, std::int64_t now_ns) noexcept {
  if (!is_scanning || options_.while_scanning == disturbance::between) {
    return line.send(answer.view(), now_ns);
  }
  if (options_.while_scanning == disturbance::drops) line.cut_front();
  line.interject(answer, now_ns);
}

void transmitter::byte_sent(bridge& to_host, std::uint32_t host_baud,
                            std::int64_t now_ns) noexcept {
  const passed_byte passing = faults_.pass(line.byte());
  const bool is_heard = options_.any_baud || is_same_rate(options_.baud, host_baud);
  bool lost = !is_heard;
  const auto take = [&](std::uint8_t byte, bool) {
    lost = !to_host.take(byte, faults_, now_ns) || lost;
  };
  if (is_heard) of_host.reset();
  for (std::uint8_t i = 0; i < passing.count; ++i) {
    if (is_heard) {
      take(passing.bytes[i], true);
    } else {
      of_host.hear(passing.bytes[i], now_ns, options_.baud, host_baud, take);
    }
  }
  const bool parted = passing.inserted && line.inside_packet();
  if (line.in_packet() && (passing.damaged || lost || parted)) line.damage();
  if (const transmission* const done = line.ending(); done != nullptr && done->count > 0) {
    truths.add(*done, !done->damaged, now_ns);
  }
  line.advance();
}

void transmitter::rest(bridge& to_host, std::int64_t now_ns) noexcept {
  of_host.rest(now_ns, [&](std::uint8_t byte, bool) {
    static_cast<void>(to_host.take(byte, faults_, now_ns));
  });
}

}  // namespace g4lidar::sim
