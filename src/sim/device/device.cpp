// SPDX-License-Identifier: MIT
// The public functions of the device: each advances the time first, and then acts.
#include "sim/exact.hpp"

#include "g4lidar/sim/device.hpp"

#include <algorithm>

#include "machine.hpp"

namespace g4lidar::sim {

device::device(const world& scene, const device_options& options, std::span<const fault> faults)
    : machine_(std::make_unique<machine>(scene, options, faults)) {}
device::device(device&&) noexcept = default;
device& device::operator=(device&&) noexcept = default;
device::~device() = default;

void device::write(bytes from_host, std::int64_t now_ns) noexcept {
  machine_->advance(now_ns);
  machine_->write(from_host);
}

host_end device::host() noexcept { return host_end(*this); }

void host_end::set_baud(std::uint32_t baud, std::int64_t now_ns) noexcept {
  device::machine& inside = *device_->machine_;
  inside.advance(now_ns);
  inside.host.set_baud(baud);
  inside.output.of_host.reset();
  inside.to_host.discard();
}

std::uint32_t host_end::baud() const noexcept { return device_->machine_->host.baud(); }

void host_end::open(std::int64_t now_ns) noexcept {
  device_->machine_->advance(now_ns);
  device_->machine_->host.open(now_ns);
  device_->machine_->update_supply();
}

void host_end::close(std::int64_t now_ns, bool keeps_dtr) noexcept {
  device_->machine_->advance(now_ns);
  device_->machine_->host.close(now_ns, keeps_dtr);
  device_->machine_->update_supply();
}

void host_end::set_dtr(bool high, std::int64_t now_ns) noexcept {
  device_->machine_->advance(now_ns);
  device_->machine_->host.set_dtr(high, now_ns);
  device_->machine_->update_supply();
}

void host_end::ignore_dtr(std::int64_t now_ns) noexcept {
  device_->machine_->advance(now_ns);
  device_->machine_->host.ignore_dtr();
  device_->machine_->update_supply();
}

std::size_t device::read(std::span<std::uint8_t> out, std::int64_t now_ns) noexcept {
  machine_->advance(now_ns);
  return machine_->to_host.read(out);
}

std::size_t device::available(std::int64_t now_ns) noexcept {
  machine_->advance(now_ns);
  return machine_->to_host.available();
}

std::int64_t device::next_ns(std::int64_t now_ns) const noexcept {
  return machine_->next_ns(now_ns);
}

bool device::is_plugged(std::int64_t now_ns) noexcept {
  machine_->advance(now_ns);
  return machine_->plug.is_in();
}

void device::unplug(std::int64_t now_ns) noexcept {
  machine_->advance(now_ns);
  machine_->hold_unplugged(true);
}

void device::replug(std::int64_t now_ns) noexcept {
  machine_->advance(now_ns);
  machine_->hold_unplugged(false);
}

std::int64_t device::next_plug_ns() const noexcept { return machine_->faults.next_edge_ns(); }

std::uint64_t device::replugs() const noexcept { return machine_->plug.replugs(); }
bool device::is_scanning() const noexcept { return machine_->is_scanning(); }
bool device::is_up() const noexcept { return machine_->is_up(); }
bool device::motor_turns() const noexcept { return machine_->head.is_driven(); }

std::uint32_t device::motor_mhz(std::int64_t now_ns) const noexcept {
  return machine_->head.speed_mhz(now_ns);
}

bool device::is_idle_and_silent(std::int64_t now_ns) const noexcept {
  const bool idle = is_up() && !is_scanning() && machine_->is_silent();
  const bool rests =
      !motor_turns() || settings().idle_power == low_power::off || machine_->host.is_ignored();
  return idle && rests && machine_->next_event().at_ns > now_ns;
}

const device_settings& device::settings() const noexcept { return machine_->settings; }

std::span<const asked> device::log() const noexcept { return machine_->log.entries(); }
std::uint64_t device::log_missed() const noexcept { return machine_->log.missed(); }
void device::clear_log() noexcept { machine_->log.clear(); }

std::size_t device::take_truth(std::span<sent_sample> out) noexcept {
  return machine_->output.truths.take(out);
}
std::uint64_t device::truth_missed() const noexcept { return machine_->output.truths.missed(); }

std::uint64_t device::bytes_delivered() const noexcept { return machine_->to_host.delivered(); }
std::uint64_t device::bytes_overflowed() const noexcept { return machine_->to_host.overflowed(); }

}  // namespace g4lidar::sim
