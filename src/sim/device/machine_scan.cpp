// SPDX-License-Identifier: MIT
// From the rotating head to the connection.
#include "sim/exact.hpp"

#include "machine.hpp"

#include <algorithm>

namespace g4lidar::sim {
namespace {

// Whether the motor of a device with power is to turn.
bool wants_motor(const device_options& options, const device_settings& settings,
                 const host_port& host, bool is_scanning) noexcept {
  if (!options.motor_has_power) return false;
  switch (options.driven_by) {
    case drive::commands:
      return is_scanning || settings.idle_power == low_power::off;
    case drive::dtr_line:
      return host.enables();
    case drive::power:
      return true;
  }
  return false;
}

}  // namespace

void device::machine::begin_scan(bool at_full_speed) noexcept {
  state_ = state::scanning;
  if (at_full_speed && wants_motor(options, settings, host, true))
    head.jump(settings.scan_frequency_chz * std::uint32_t{10}, now_ns_);
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
  const bool wanted = is_up() && wants_motor(options, settings, host, is_scanning());
  const bool starts = wanted && !head.is_driven();
  head.drive(wanted ? settings.scan_frequency_chz * std::uint32_t{10} : 0, now_ns_);
  if (!wanted) death_ns_ = forever_ns;
  if (!starts) return;
  const fault* weak = faults.find(fault_kind::brown_out);
  if (weak == nullptr) weak = faults.find(fault_kind::reboot);
  if (weak != nullptr) death_ns_ = now_ns_ + weak->amount;
}

}  // namespace g4lidar::sim
