// SPDX-License-Identifier: MIT
// A wait asks the device for its next event and sets the clock to that time.
#include "g4lidar/sim/virtual_port.hpp"

#include <algorithm>
#include <cerrno>
#include <new>
#include <utility>

namespace g4lidar::sim {

virtual_port::virtual_port(device& simulated, virtual_clock& clock, std::string_view name) noexcept
    : device_(&simulated), clock_(&clock), name_(name), replugs_(simulated.replugs()) {
  device_->host().open(clock_->now_ns());
}

virtual_port::~virtual_port() {
  const std::int64_t now = clock_->now_ns();
  if (device_->is_plugged(now) && device_->replugs() == replugs_)
    device_->host().close(now, is_kept_);
}

// Whether the port still exists, and no wake() ended the call.
result<void> virtual_port::look(task doing) noexcept {
  const bool plugged = device_->is_plugged(clock_->now_ns());
  if (!plugged || device_->replugs() != replugs_) return failure(doing, problem::gone, name_);
  if (woken_.exchange(false, std::memory_order_relaxed)) {
    return failure(doing, problem::cancelled, name_);
  }
  return {};
}

result<received> virtual_port::read(std::span<std::uint8_t> out,
                                    std::int64_t deadline_ns) noexcept {
  clock_->tick();
  for (;;) {
    if (const result<void> seen = look(task::reading); !seen) {
      return tl::unexpected<error>(seen.error());
    }
    const std::int64_t now = clock_->now_ns();
    const std::size_t count = device_->read(out, now);
    if (count > 0 || now >= deadline_ns) return received{count, now};
    clock_->advance_to(std::clamp(device_->next_ns(now), now + 1, deadline_ns));
  }
}

result<void> virtual_port::write(bytes data, std::int64_t) noexcept {
  clock_->tick();
  if (const result<void> seen = look(task::writing); !seen) return seen;
  device_->write(data, clock_->now_ns());
  return {};
}

result<void> virtual_port::pause(std::int64_t deadline_ns) noexcept {
  clock_->tick();
  for (;;) {
    if (const result<void> seen = look(task::reading); !seen) return seen;
    const std::int64_t now = clock_->now_ns();
    if (now >= deadline_ns) return {};
    clock_->advance_to(std::clamp(device_->next_plug_ns(), now + 1, deadline_ns));
  }
}

result<bool> virtual_port::set_baud(std::uint32_t baud) noexcept {
  clock_->tick();
  if (const result<void> seen = look(task::configuring); !seen) return tl::unexpected(seen.error());
  device_->host().set_baud(baud, clock_->now_ns());
  return true;
}

result<bool> virtual_port::set_dtr(bool high) noexcept {
  clock_->tick();
  if (const result<void> seen = look(task::configuring); !seen) return tl::unexpected(seen.error());
  device_->host().set_dtr(high, clock_->now_ns());
  is_raised_ = high;
  is_kept_ = is_kept_ && high;
  return true;
}

result<std::unique_ptr<transport>> virtual_connector::connect() noexcept {
  clock_->tick();
  for (std::size_t i = 0; i < devices_.size(); ++i) {
    device& simulated = *devices_[next_];
    next_ = (next_ + 1) % devices_.size();
    if (!simulated.is_plugged(clock_->now_ns())) continue;
    std::unique_ptr<transport> port(new (std::nothrow) virtual_port(simulated, *clock_));
    if (port == nullptr) return failure(task::opening, problem::system, "virtual:g4", ENOMEM);
    if (baud_ != 0) simulated.host().set_baud(baud_, clock_->now_ns());
    return port;
  }
  return failure(task::opening, problem::no_port, "virtual:g4");
}

bool virtual_connector::pause(std::int64_t deadline_ns) noexcept {
  clock_->tick();
  if (woken_.exchange(false, std::memory_order_relaxed)) return false;
  clock_->advance_to(deadline_ns);
  return true;
}

}  // namespace g4lidar::sim
