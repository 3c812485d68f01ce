// SPDX-License-Identifier: MIT
// From the rotating head to the connection.
#include "exact.hpp"

#include "machine.hpp"

#include <algorithm>

namespace g4lidar::sim {

void device::machine::begin_scan() noexcept {
  state_ = state::scanning;
  fed_ns_ = now_ns_;
  stopped_by_protection_ = false;
  keep_motor();
  scanner_.resume(now_ns_, phases_.next());
  measure();
}

void device::machine::end_scan() noexcept {
  if (!is_scanning()) return;
  state_ = state::idle;
  packet_ns_ = forever_ns;
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

// The next packet, as it will be when its last sample has been measured.
void device::machine::measure() noexcept {
  scanner_.set_speed_mhz(head.speed_mhz(scanner_.next_sample_ns()));
  const bool jolts = faults_.strike(fault_kind::jolt) != nullptr &&
                     settings.direction == motor_direction::clockwise;
  if (jolts) scanner_.set_turning(turning::falling);
  const sent_packet packet = scanner_.next();
  if (jolts) scanner_.set_turning(turning::clockwise);
  std::optional<std::uint8_t> stray;
  if (options_.stray_before_zero && (packet.data[2] & 1U) != 0) {
    stray = static_cast<std::uint8_t>(strays_.next() >> 56);
  }
  measuring_.assign(packet, stray);
  packet_ns_ = packet.complete_ns;
}

void device::machine::packet_measured() noexcept {
  if (now_ns_ < silent_until_ns_) return measure();
  measuring_.packet = packets_++;
  if (faults_.strike(fault_kind::truncate) != nullptr) {
    const auto most = static_cast<std::uint64_t>(measuring_.size - measuring_.begin - 1);
    const std::uint64_t stays = 1 + faults_.draw(fault_kind::truncate, most);
    measuring_.size = static_cast<std::uint8_t>(measuring_.begin + stays);
    measuring_.damaged = true;
  }
  wire_.say(measuring_, now_ns_);
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
