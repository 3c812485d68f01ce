// SPDX-License-Identifier: MIT
// A reader that opens the lidar itself, and what came to its listener.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <string>

#include "g4lidar/background_reader.hpp"
#include "g4lidar/sim/pty_port.hpp"
#include "g4lidar/sim/world.hpp"
#include "reader_record.hpp"
#include "recording/recorded_run.hpp"

namespace g4lidar::test {

inline constexpr std::int64_t second = 1'000'000'000;
inline constexpr std::int64_t recorded_ahead_ns = 1'700'000'000 * second;

class ReaderListener : public ::testing::Test {
 protected:
  background_reader& begin(const std::string& device, lidar_options options = {},
                           const reader_options& how = {}) {
    options.device = device;
    made_ = std::make_unique<background_reader>(options, how, &heard);
    heard.of = made_.get();
    EXPECT_TRUE(made_->start());
    return *made_;
  }
  /// A simulated G4 at `port()`.
  sim::background_pty plug_in() {
    return *sim::background_pty::open(sim::device(sim::built_in_world()), port());
  }
  [[nodiscard]] const std::string& port() const { return port_.text(); }
  /// So many seconds, after 1 s of the simulation, of which the head speeds up in the first one: 7 revolutions a second.
  const std::string& recording(int seconds) {
    auto writer = recording_writer::create(file_.text());
    EXPECT_TRUE(writer);
    writer->set_wall_clock(recorded_ahead_ns);
    record_device(*writer, (seconds + 1) * second);
    return file_.text();
  }
  static bool is_scanning(sim::background_pty& port) {
    bool is = false;
    port.with([&](sim::device& device, std::int64_t now_ns) {
      static_cast<void>(device.available(now_ns));
      is = device.is_scanning();
    });
    return is;
  }
  /// What ask() gives.
  bool is_null(background_reader& of) {
    int given = -1;
    of.ask([&](lidar* device) {
      const std::lock_guard lock(heard.mutex);
      given = device == nullptr ? 1 : 0;
      heard.changed.notify_all();
    });
    EXPECT_TRUE(heard.wait([&] { return given >= 0; }));
    return given == 1;
  }

  reader_record heard;

 private:
  temporary_path file_;
  temporary_path port_{"port"};
  std::unique_ptr<background_reader> made_;
};

}  // namespace g4lidar::test
