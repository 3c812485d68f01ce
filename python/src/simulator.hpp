// SPDX-License-Identifier: MIT
// Simulated lidars, in virtual and in real time.
#pragma once

#include <nanobind/nanobind.h>

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "g4lidar/sim/device.hpp"
#include "g4lidar/sim/pty_port.hpp"
#include "g4lidar/sim/setup.hpp"
#include "g4lidar/sim/virtual_port.hpp"
#include "process.hpp"

namespace g4lidar::python {

/// A device and its time. Its users hold the mutex.
struct virtual_simulation {
  explicit virtual_simulation(sim::device made) : device(std::move(made)) {}
  sim::device device;
  sim::virtual_clock clock;
};

/// A device in real time, until it is closed. A Simulator and its lidars share it. Guarded by the GIL.
struct real_simulation {
  std::shared_ptr<sim::background_pty> port;
};

/// Python's class Simulator: one device, in virtual time or on a pty with a thread.
class simulator {
 public:
  simulator(const sim::setup& setup, bool virtual_time);
  simulator(const simulator&) = delete;
  simulator& operator=(const simulator&) = delete;
  ~simulator();

  [[nodiscard]] bool is_virtual() const noexcept { return virtual_ != nullptr; }
  [[nodiscard]] const std::shared_ptr<virtual_simulation>& in_virtual_time() const noexcept {
    return virtual_;
  }
  [[nodiscard]] const std::shared_ptr<std::timed_mutex>& mutex() const noexcept { return mutex_; }
  [[nodiscard]] const std::shared_ptr<real_simulation>& in_real_time() const noexcept {
    return real_;
  }
  /// The model that it simulates.
  [[nodiscard]] const model* simulated() const noexcept { return model_; }
  /// The name for open(): a path. Raises RuntimeError in virtual time.
  [[nodiscard]] std::string path() const;
  /// Removes the port of a device in real time.
  void close();

  /// `look(device, now_ns)`, between two steps of the device.
  template <class Look>
  auto with(const Look& look);

 private:
  const model* model_;
  std::shared_ptr<virtual_simulation> virtual_;
  std::shared_ptr<real_simulation> real_ = std::make_shared<real_simulation>();
  std::shared_ptr<std::timed_mutex> mutex_ = std::make_shared<std::timed_mutex>();
  process process_;
};

template <class Look>
auto simulator::with(const Look& look) {
  process_.check("this simulated lidar");
  std::optional<decltype(look(virtual_->device, std::int64_t{}))> found;
  if (virtual_) {
    const auto lock = lock_of(*mutex_);
    found = look(virtual_->device, virtual_->clock.now_ns());
  } else if (auto port = real_->port) {  // a copy: close() of another thread leaves it alone
    const without_gil free;
    port->with([&](sim::device& device, std::int64_t now_ns) { found = look(device, now_ns); });
    port.reset();
  } else {
    static_cast<void>(path());  // raises
  }
  return *std::move(found);
}

/// The device of a setup. Raises BadOption for a world that cannot be read.
[[nodiscard]] sim::device make_device(const sim::setup& setup);
/// The setup of "sim:?...". Raises BadOption.
[[nodiscard]] sim::setup read_setup(std::string_view source);

void bind_simulator(nb::module_& module);

}  // namespace g4lidar::python
