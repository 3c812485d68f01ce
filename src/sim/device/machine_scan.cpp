// SPDX-License-Identifier: MIT
// From the rotating head to the connection.
#include "sim/exact.hpp"

#include "machine.hpp"

#include <algorithm>

namespace g4lidar::sim {

void device::machine::begin_scan(bool at_full_speed) noexcept {
  if (at_full_speed) head.jump(settings.scan_frequency_chz * std::uint32_t{10}, now_ns_);
  state_ = state::scanning;
  fed_ns_ = now_ns_;
  stopped_by_protection_ = false;
  keep_motor();
  output.samples.begin(now_ns_);
  output.measure(head, settings.direction);
}

/// A second stop does not delay the end. A device that sends nothing yet has nothing left to send.
void device::machine::stop_scan() noexcept {
  if (!is_scanning()) return;
  if (options.stop_ns == 0 || output.samples.is_silent(now_ns_)) return end_scan();
  output.samples.end_at(std::min(output.samples.end_ns(), now_ns_ + options.stop_ns));
}

void device::machine::end_scan() noexcept {
  if (!is_scanning()) return;
  state_ = state::idle;
  output.samples.end();
  answers_.forget_header();
  output.line.cut(options.stop_truncates);
  keep_motor();
}

void device::machine::keep_motor() noexcept {
  const bool idles = is_up() && settings.idle_power == low_power::off;
  const bool wanted = is_scanning() || idles;
  const bool starts = wanted && !head.is_driven();
  head.drive(wanted ? settings.scan_frequency_chz * std::uint32_t{10} : 0, now_ns_);
  if (!wanted) death_ns_ = forever_ns;
  if (!starts) return;
  const fault* weak = faults.find(fault_kind::brown_out);
  if (weak == nullptr) weak = faults.find(fault_kind::reboot);
  if (weak != nullptr) death_ns_ = now_ns_ + weak->amount;
}

}  // namespace g4lidar::sim
