// SPDX-License-Identifier: MIT
// A simulated G4 in the process of the test, and recordings, made without waiting.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/program.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/device.hpp"
#include "g4lidar/sim/pty_port.hpp"
#include "g4lidar/sim/setup.hpp"
#include "g4lidar/sim/world.hpp"

namespace ros2 {

namespace sim = g4lidar::sim;

/// On a pseudo-terminal, with a thread of its own.
class served_lidar {
 public:
  served_lidar() : port_(sim::serve_alone(sim::device(sim::built_in_world())).value()) {}
  /// Of another model, with these faults.
  explicit served_lidar(const std::string& model, const std::vector<sim::fault>& faults = {})
      : port_(sim::serve_alone(device_of(model, faults)).value()) {}

  [[nodiscard]] std::string path() const { return port_->path(); }
  [[nodiscard]] bool motor_turns() const {
    bool turns = false;
    port_->with(
        [&turns](const sim::device& device, std::int64_t) { turns = device.motor_turns(); });
    return turns;
  }
  [[nodiscard]] sim::device_settings settings() const {
    sim::device_settings now;
    port_->with([&now](const sim::device& device, std::int64_t) { now = device.settings(); });
    return now;
  }
  /// Appends when zero packets were sent, by std::chrono::steady_clock.
  void take_zero_packets(std::vector<std::int64_t>& times_ns) const {
    port_->with([&times_ns](sim::device& device, std::int64_t now_ns) {
      const std::int64_t ahead_ns =
          std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count() -
          now_ns;
      std::array<sim::sent_sample, 256> samples;
      while (const std::size_t count = device.take_truth(samples)) {
        for (std::size_t i = 0; i < count; ++i) {
          if (samples[i].zero) times_ns.push_back(samples[i].sent_ns + ahead_ns);
        }
      }
    });
  }
  void unplug(bool is_out) const {
    port_->with([is_out](sim::device& device, std::int64_t now_ns) {
      is_out ? device.unplug(now_ns) : device.replug(now_ns);
    });
  }

 private:
  static sim::device device_of(const std::string& model, const std::vector<sim::fault>& faults) {
    sim::device_options options;
    EXPECT_TRUE(sim::use_model(options, model)) << model;
    return sim::device(sim::built_in_world(), options, faults);
  }

  std::shared_ptr<sim::background_pty> port_;
};

/// A recording of so many seconds at `path`, with more options of `g4-dump sim` and `g4-dump convert`.
inline void make_recording(const std::string& path, int seconds, const std::string& simulated = "",
                           const std::string& converted = "") {
  const std::string tool = G4_DUMP_TOOL;
  const std::string line = tool + " sim --seconds " + std::to_string(seconds) + " " + simulated +
                           " -o " + path + ".bin 2>/dev/null && " + tool + " convert -q " + path +
                           ".bin " + path + " " + converted + " 2>/dev/null";
  ASSERT_EQ(std::system(line.c_str()), 0) << line;
}

/// The whole revolutions of a recording, as the library plays them.
inline std::vector<g4lidar::owned_scan> scans_of(const std::string& path) {
  std::vector<g4lidar::owned_scan> all;
  auto opened = g4lidar::lidar::open("file:" + path);
  EXPECT_TRUE(opened && opened->start());
  while (opened) {
    const auto scan = opened->try_scan(std::chrono::milliseconds(500));
    if (!scan) break;
    all.emplace_back(*scan);
  }
  return all;
}

}  // namespace ros2
