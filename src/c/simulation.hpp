// SPDX-License-Identifier: MIT
// A simulated lidar behind a handle: on a pseudo-terminal with a thread of its own, or in virtual time.
#pragma once

#include <g4lidar/c/simulator.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "g4lidar/sim/odometry.hpp"
#include "g4lidar/sim/pty_port.hpp"
#include "g4lidar/sim/virtual_port.hpp"
#include "g4lidar/sim/world.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar::c {

class simulation {
 public:
  /// In virtual time.
  simulation(const sim::world& scene, std::uint64_t seed, sim::device simulated)
      : device_(std::move(simulated)) {
    follow_robot(scene, seed);
  }
  /// In real time.
  simulation(const sim::world& scene, std::uint64_t seed,
             std::shared_ptr<sim::background_pty> served);

  [[nodiscard]] bool is_virtual() const noexcept { return device_.has_value(); }
  /// Of its port; empty in virtual time.
  [[nodiscard]] std::string path() const { return served_ ? served_->path() : std::string(); }
  [[nodiscard]] sim::virtual_clock& clock() noexcept { return clock_; }
  /// In virtual time.
  [[nodiscard]] std::unique_ptr<connector> connect();
  /// The model that it simulates.
  [[nodiscard]] const model* simulated() const noexcept { return model_; }
  void set_simulated(const model* model) noexcept { model_ = model; }

  /// Calls `look` with the device and its time.
  template <class Look>
  void with(Look look) {
    if (served_) return served_->with(look);
    if (device_) look(*device_, clock_.now_ns());
  }
  /// The next sample of a robot, by the clock of the points; nothing if its time has not come.
  [[nodiscard]] std::optional<sim::odometry_sample> next_odometry();

 private:
  void follow_robot(const sim::world& scene, std::uint64_t seed);

  const model* model_ = nullptr;
  std::shared_ptr<sim::background_pty> served_;
  std::optional<sim::device> device_;
  sim::virtual_clock clock_;
  std::optional<sim::odometry> way_;
  std::int64_t begin_ns_ = 0;  // its time 0, by the clock of the points
};

/// Fills `made`. Fails like g4lidar_simulator_create().
int simulate(const g4lidar_simulator_options& options, std::shared_ptr<simulation>& made,
             g4lidar_error* error);

}  // namespace g4lidar::c

struct g4lidar_simulator {
  std::shared_ptr<g4lidar::c::simulation> made;
  std::string path;
  g4lidar_simulator_state state{};
};
