// SPDX-License-Identifier: MIT
// From the rotating head to the connection.
#include "sim/exact.hpp"

#include "machine.hpp"

#include <algorithm>

namespace g4lidar::sim {

void device::machine::begin_scan() noexcept {
  state_ = state::scanning;
  fed_ns_ = now_ns_;
  stopped_by_protection_ = false;
  keep_motor();
  sampler_.begin(now_ns_);
  measure();
}

void device::machine::begin_at_full_speed() noexcept {
  head.jump(settings.scan_frequency_chz * std::uint32_t{10}, now_ns_);
  begin_scan();
}

/// A second stop does not delay the end. A device that sends nothing yet has nothing left to send.
void device::machine::stop_scan() noexcept {
  if (!is_scanning()) return;
  if (options_.stop_ns == 0 || sampler_.is_silent(now_ns_)) return end_scan();
  sampler_.end_at(std::min(sampler_.end_ns(), now_ns_ + options_.stop_ns));
}

void device::machine::end_scan() noexcept {
  if (!is_scanning()) return;
  state_ = state::idle;
  sampler_.end();
  forget_header();
  wire_.cut(options_.stop_truncates);
  keep_motor();
}

void device::machine::keep_motor() noexcept {
  const bool idles = is_up() && settings.idle_power == low_power::off;
  const bool wanted = is_scanning() || idles;
  const bool starts = wanted && !head.is_driven();
  head.drive(wanted ? settings.scan_frequency_chz * std::uint32_t{10} : 0, now_ns_);
  if (!wanted) death_ns_ = forever_ns;
  if (!starts) return;
  const fault* weak = faults_.find(fault_kind::brown_out);
  if (weak == nullptr) weak = faults_.find(fault_kind::reboot);
  if (weak != nullptr) death_ns_ = now_ns_ + weak->amount;
}

void device::machine::measure() noexcept {
  const bool jolts = faults_.strike(fault_kind::jolt) != nullptr &&
                     settings.direction == motor_direction::clockwise;
  sampler_.measure(head, jolts, options_);
}

void device::machine::packet_measured() noexcept {
  transmission* const packet = sampler_.take(now_ns_);
  if (packet == nullptr) return measure();
  if (const auto clock = sampler_.take_time_packet(now_ns_, options_.time_packet_ns)) {
    wire_.send(*clock, now_ns_);
  }
  if (faults_.strike(fault_kind::omit) != nullptr) return measure();
  if (faults_.strike(fault_kind::truncate) != nullptr) {
    const auto most = static_cast<std::uint64_t>(packet->size - packet->begin - 1);
    const std::uint64_t stays = 1 + faults_.draw(fault_kind::truncate, most);
    packet->size = static_cast<std::uint8_t>(packet->begin + stays);
    packet->damaged = true;
  }
  wire_.send(*packet, now_ns_);
  measure();
}

void device::machine::byte_sent() noexcept {
  const passed_byte passing = faults_.pass(wire_.byte());
  bool lost = false;
  for (std::uint8_t i = 0; i < passing.count; ++i) {
    lost = !to_host.take(passing.bytes[i], faults_, now_ns_) || lost;
  }
  const bool parted = passing.inserted && wire_.inside_packet();
  if (wire_.in_packet() && (passing.damaged || lost || parted)) wire_.damage();
  if (const transmission* const done = wire_.ending(); done != nullptr && done->count > 0) {
    truths.add(*done, !done->damaged, now_ns_);
  }
  wire_.advance();
}

}  // namespace g4lidar::sim
