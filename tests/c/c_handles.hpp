// SPDX-License-Identifier: MIT
// Handles of the C interface that release themselves, and lidars on simulated devices.
#pragma once

#include <g4lidar.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "support/patience.hpp"

namespace g4lidar_c_test {

/// Releases a handle with `Free`.
template <auto Free>
struct freed {
  template <class Handle>
  void operator()(Handle* handle) const {
    Free(handle);
  }
};
template <class Handle, auto Free>
using owned = std::unique_ptr<Handle, freed<Free>>;

using lidar = owned<g4lidar_lidar, g4lidar_free>;
using simulator = owned<g4lidar_simulator, g4lidar_simulator_free>;
using recorder = owned<g4lidar_recorder, g4lidar_recorder_free>;
using reader = owned<g4lidar_reader, g4lidar_reader_free>;
using shaper = owned<g4lidar_shaper, g4lidar_shaper_free>;
using ports = owned<g4lidar_ports, g4lidar_ports_free>;

inline g4lidar_point at(float angle_deg, float range_mm, std::int64_t time_ns = 1) {
  g4lidar_point made{};
  made.angle_deg = angle_deg;
  made.range_mm = range_mm;
  made.time_ns = time_ns;
  if (range_mm == 0.0F) made.flags = G4LIDAR_NO_RETURN;
  if (range_mm > 0.0F && range_mm < 100.0F) made.flags = G4LIDAR_TOO_NEAR;
  return made;
}

/// A simulated lidar in virtual time.
inline simulator simulate(const char* setup = nullptr, const char* world = nullptr,
                          const char* path = nullptr) {
  g4lidar_simulator_options options;
  g4lidar_simulator_options_init(&options, sizeof options);
  options.setup = setup;
  options.world = world;
  options.path = path;
  options.virtual_time = true;
  g4lidar_simulator* made = nullptr;
  g4lidar_error why;
  EXPECT_EQ(g4lidar_simulator_create(&options, &made, &why), G4LIDAR_OK) << why.message;
  return simulator(made);
}

inline g4lidar_options defaults() {
  g4lidar_options options;
  g4lidar_options_init(&options, sizeof options);
  return options;
}

inline lidar open_on(const simulator& on, const g4lidar_options* options = nullptr) {
  g4lidar_lidar* made = nullptr;
  g4lidar_error why;
  EXPECT_EQ(g4lidar_open_simulated(on.get(), options, &made, &why), G4LIDAR_OK) << why.message;
  return lidar(made);
}

/// The same, started.
inline lidar start_on(const simulator& on, const g4lidar_options* options = nullptr) {
  lidar made = open_on(on, options);
  g4lidar_error why;
  EXPECT_EQ(g4lidar_start(made.get(), &why), G4LIDAR_OK) << why.message;
  return made;
}

/// The next whole revolution; null after an error.
inline const g4lidar_scan* next_whole(const lidar& from) {
  const g4lidar_scan* scan = nullptr;
  g4lidar_error why;
  for (int i = 0; i < 10; ++i) {
    if (g4lidar_try_scan(from.get(), g4lidar::test::patience_ms, &scan, &why) != G4LIDAR_OK) break;
    if (scan->is_whole) return scan;
  }
  ADD_FAILURE() << why.message;
  return nullptr;
}

/// The fifth one: the motor has its speed then.
inline const g4lidar_scan* scan_at_speed(const lidar& from) {
  for (int i = 0; i < 4; ++i) next_whole(from);
  return next_whole(from);
}

inline g4lidar_shaper_options shaper_defaults() {
  g4lidar_shaper_options options;
  g4lidar_shaper_options_init(&options, sizeof options);
  return options;
}

inline shaper make(const g4lidar_shaper_options& options) {
  g4lidar_shaper* made = nullptr;
  g4lidar_error why;
  EXPECT_EQ(g4lidar_shaper_create(&options, &made, &why), G4LIDAR_OK) << why.message;
  return shaper(made);
}

inline std::span<const g4lidar_point> kept_by(const shaper& by) {
  std::size_t count = 99;
  const g4lidar_point* const points = g4lidar_shaper_kept(by.get(), &count);
  return {points, count};
}

/// The points that a new shaper keeps of a piece of a revolution.
inline std::vector<g4lidar_point> shaped(const g4lidar_shaper_options& options,
                                         std::span<const g4lidar_point> points,
                                         std::span<const g4lidar_stamped_pose> path = {}) {
  const shaper by = make(options);
  EXPECT_EQ(
      g4lidar_shaper_shape(by.get(), points.data(), points.size(), true, path.data(), path.size()),
      G4LIDAR_OK);
  const auto kept = kept_by(by);
  return {kept.begin(), kept.end()};
}

/// A directory that is removed with its files.
class scratch {
 public:
  scratch();
  scratch(const scratch&) = delete;
  scratch& operator=(const scratch&) = delete;
  ~scratch();
  /// A path in it.
  [[nodiscard]] std::string path(const std::string& name) const { return directory_ + "/" + name; }

 private:
  std::string directory_;
};

}  // namespace g4lidar_c_test
