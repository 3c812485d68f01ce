// SPDX-License-Identifier: MIT
// The stages of a running diagnosis, while another thread reads the lidar.
#include "g4lidar/diagnostics/running_diagnosis.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>

#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/virtual_port.hpp"
#include "g4lidar/sim/world.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;

TEST(RunningDiagnosis, StagesInAnotherThread) {
  sim::device simulated(sim::built_in_world(), {});
  sim::virtual_clock clock;
  running_diagnosis judge;
  std::atomic<bool> is_over = false;
  std::thread reader([&] {
    auto device =
        lidar::open(judge.observe(std::make_unique<sim::virtual_connector>(simulated, clock)));
    if (device && device->start()) {
      while (clock.now_ns() < 30'000'000'000) static_cast<void>(device->try_scan(200ms));
    }
    is_over = true;
  });
  bool is_last = false;
  while (!is_last) {
    is_last = is_over;
    for (const stage_report& stage : judge.stages()) EXPECT_TRUE(stage.diagnoses.empty());
  }
  reader.join();
}

}  // namespace
}  // namespace g4lidar
