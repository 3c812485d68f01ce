// SPDX-License-Identifier: MIT
// A wait asks the device for its next event and sets the clock to that time.
#include "g4lidar/sim/virtual_port.hpp"

#include <algorithm>
#include <new>
#include <utility>

namespace g4lidar::sim {

virtual_port::virtual_port(device& twin, virtual_clock& clock, std::string_view name) noexcept
    : twin_(&twin), clock_(&clock), name_(name), replugs_(twin.replugs()) {}

// Whether the port still exists, and no wake() ended the call.
result<void> virtual_port::look(task doing) noexcept {
  const bool plugged = twin_->is_plugged(clock_->now_ns());
  if (!plugged || twin_->replugs() != replugs_) return failure(doing, problem::gone, name_);
  if (woken_.exchange(false, std::memory_order_relaxed)) {
    return failure(doing, problem::cancelled, name_);
  }
  return {};
}

result<received> virtual_port::read(std::span<std::uint8_t> out,
                                    std::int64_t deadline_ns) noexcept {
  clock_->tick();
  for (;;) {
    if (const result<void> line = look(task::reading); !line) {
      return tl::unexpected<error>(line.error());
    }
    const std::int64_t now = clock_->now_ns();
    const std::size_t count = twin_->read(out, now);
    if (count > 0 || now >= deadline_ns) return received{count, now};
    clock_->advance_to(std::clamp(twin_->next_ns(now), now + 1, deadline_ns));
  }
}

result<void> virtual_port::write(bytes data, std::int64_t) noexcept {
  clock_->tick();
  if (const result<void> line = look(task::writing); !line) return line;
  twin_->write(data, clock_->now_ns());
  return {};
}

result<void> virtual_port::pause(std::int64_t deadline_ns) noexcept {
  clock_->tick();
  for (;;) {
    if (const result<void> line = look(task::reading); !line) return line;
    const std::int64_t now = clock_->now_ns();
    if (now >= deadline_ns) return {};
    clock_->advance_to(std::clamp(twin_->next_plug_ns(), now + 1, deadline_ns));
  }
}

result<std::unique_ptr<transport>> virtual_connector::connect() noexcept {
  clock_->tick();
  for (std::size_t i = 0; i < twins_.size(); ++i) {
    device& twin = *twins_[next_];
    next_ = (next_ + 1) % twins_.size();
    if (!twin.is_plugged(clock_->now_ns())) continue;
    std::unique_ptr<transport> port(new (std::nothrow) virtual_port(twin, *clock_));
    if (port == nullptr) break;
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
