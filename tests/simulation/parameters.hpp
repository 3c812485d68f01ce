// SPDX-License-Identifier: MIT
// What a simulation run consists of, drawn from its seed: a device, a driver's options, faults, an application.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/device.hpp"
#include "g4lidar/sim/device_options.hpp"
#include "g4lidar/sim/random.hpp"

namespace g4lidar::simulation {

inline constexpr std::int64_t ms = 1'000'000;
inline constexpr std::int64_t second = 1'000 * ms;

/// Numbers for decisions.
class dice {
 public:
  dice(std::uint64_t seed, std::uint64_t purpose) : random_(seed, purpose) {}

  [[nodiscard]] bool chance(double p) { return random_.uniform() < p; }
  /// From `least` to `most`, both included.
  [[nodiscard]] std::int64_t between(std::int64_t least, std::int64_t most) {
    const auto span = static_cast<std::uint64_t>(most - least) + 1;
    return least + static_cast<std::int64_t>(random_.next() % span);
  }
  [[nodiscard]] double real(double least, double most) {
    return least + (most - least) * random_.uniform();
  }
  /// Each power of ten as likely as the next.
  [[nodiscard]] double spread(double least, double most);

 private:
  sim::random_stream random_;
};

/// How the application behaves: how likely each act is, and how long it sleeps at most.
struct application_behavior {
  double scans = 1.0;
  double points = 0.0;
  double process = 0.0;
  double sleep = 0.0;
  double wake = 0.0;
  double ask = 0.0;
  double stop = 0.0;
  double reopen = 0.0;
  double move = 0.0;
  std::int64_t longest_sleep_ns = 0;
};

struct run_parameters {
  std::uint64_t seed = 0;
  bool healthy = false;      ///< No faults, and an application that keeps up.
  std::int64_t calm_ns = 0;  ///< From then on no fault is at work, and the application only reads.
  std::int64_t end_ns = 0;   ///< Then it closes.
  sim::device_options device;
  std::vector<sim::fault> faults;
  std::uint32_t bridge_baud = 0;  ///< What the bridge makes of the rate of the device; 0: the same.
  int unanswered = 0;             ///< So many questions of an opening have no answer.
  lidar_options options;
  application_behavior application;
};

/// Of a G4, or of the model of this name.
[[nodiscard]] run_parameters draw_run(std::uint64_t seed, std::string_view model = {});

/// Makes of them those of the model of this name: what only a G4 has is left out.
void become(dice& d, std::string_view model, run_parameters& parameters);

/// Whether the device reports a number that its model has not.
[[nodiscard]] bool has_other_number(const run_parameters& parameters);
/// Whether nothing is wrong with the device where this is reported.
[[nodiscard]] bool is_usual(const run_parameters& parameters, lidar_event::kind what);

/// How long the device needs by itself for a whole revolution: boot, answers, spin-up, two turns.
[[nodiscard]] std::int64_t own_time_ns(const run_parameters& parameters);
/// A whole revolution is there so long after the last fault has ended.
[[nodiscard]] std::int64_t recovery_time_ns(const run_parameters& parameters);

/// In words that a person reads, several lines.
[[nodiscard]] std::string describe(const run_parameters& parameters);

}  // namespace g4lidar::simulation
