// SPDX-License-Identifier: MIT
// The running diagnosis names the same faults as the doctor, while a driver uses the lidar.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "diagnostics/odd_links.hpp"
#include "diagnostics/running_bench.hpp"
#include "support/test_scale.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::test;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t second = 1'000 * ms;

struct expectation {
  std::string_view name;
  std::vector<std::string_view> faults;
  std::string_view diagnoses;
  bool reconnects = true;
  bool is_damage = false;  // from 6 s on
};

void PrintTo(const expectation& one, std::ostream* out) { *out << one.name; }

class RunningFault : public ::testing::TestWithParam<expectation> {};

TEST_P(RunningFault, GetsItsOwnDiagnosis) {
  const expectation& expected = GetParam();
  for (const int seed : test::seeds(3)) {
    use how;
    for (const std::string_view text : expected.faults) {
      how.faults.push_back(std::get<sim::fault>(sim::parse_fault(text)));
    }
    how.device.scanner.seed = static_cast<std::uint64_t>(seed);
    how.options.reconnect = expected.reconnects;
    for (const bool takes_points : {false, true}) {
      how.takes_points = takes_points;
      const seen found = watch(how);
      // Few damaged packets do not show their kind: once there are more, there is no other diagnosis.
      const std::size_t last = found.looks.size() - 1;
      const std::string all = expected.is_damage ? found.diagnoses(last) : found.diagnoses();
      ASSERT_EQ(all, expected.diagnoses) << "seed " << seed << takes_points << found;
      if (expected.is_damage) {
        ASSERT_EQ(found.diagnoses(4), "") << found;
      }
    }
  }
}

// The same faults as those of the doctor that occur in a running scan, and its diagnoses of them.
const std::vector<expectation> expectations{
    {"flip", {"flip@6s"}, "bits_flipped", true, true},
    {"flip_often", {"flip*0.01@6s"}, "bits_flipped", true, true},
    {"drop", {"drop@6s"}, "bytes_dropped", true, true},
    {"drop_often", {"drop*0.01@6s"}, "bytes_dropped", true, true},
    {"insert", {"insert@6s"}, "bytes_inserted", true, true},
    {"insert_often", {"insert*0.01@6s"}, "bytes_inserted", true, true},
    {"burst", {"burst@6s"}, "bursts", true, true},
    {"burst_short", {"burst=4@6s"}, "bursts", true, true},
    {"burst_long", {"burst=100@6s"}, "bursts", true, true},
    {"truncate", {"truncate@6s"}, "packets_truncated", true, true},
    {"truncate_often", {"truncate*0.1@6s"}, "packets_truncated", true, true},
    {"stall", {"stall@8s+900ms"}, "stalls"},
    {"stall_short", {"stall@8s+260ms"}, "stalls"},
    {"stall_for_ever", {"stall@8s"}, "stalls", false},
    {"batch", {"batch"}, "usb_latency"},
    {"batch_short", {"batch=8ms"}, "usb_latency"},
    {"baud_later", {"baud@8s"}, "wrong_baud_rate", false},
    {"brown_out", {"brown_out"}, "brown_out", false},
    {"reboot_later", {"reboot=4s"}, "reboots"},
    {"unplug", {"unplug@8s+1s"}, "unplugged"},
    {"unplug_for_ever", {"unplug@8s"}, "unplugged", false},
    {"health_warning", {"health=warning"}, "health_warning"},
    {"health_error", {"health=error"}, "health_error"},
    {"jolt", {"jolt@6s"}, "jolts"},
    {"batch_and_flip", {"batch", "flip@6s"}, "bits_flipped usb_latency"},
};

INSTANTIATE_TEST_SUITE_P(All, RunningFault, ::testing::ValuesIn(expectations),
                         [](const auto& one) { return std::string(one.param.name); });

struct scenario {
  std::string_view name;
  std::string_view diagnoses;
  use how;
};

void PrintTo(const scenario& one, std::ostream* out) { *out << one.name; }

use with_device(const std::function<void(sim::device_options&)>& change) {
  use how;
  change(how.device);
  return how;
}
use with_link(const wrapper& wrap, bool reconnects = false) {
  use how;
  how.wrap = wrap;
  how.options.reconnect = reconnects;
  return how;
}

std::vector<scenario> scenarios() {
  std::vector<scenario> all{
      {"interference", "interference",
       with_link(wrap_in<broken_link>(8 * second, problem::interference))},
      {"broken", "system", with_link(wrap_in<broken_link>(8 * second, problem::system))},
      {"does_not_start", "does_not_start", with_link(wrap_in<link_without_start>())},
      {"scan_ends", "scan_ends", with_link(wrap_in<link_that_stops>())},
      {"line_noise", "line_noise", with_link(wrap_in<noisy_link>())},
      {"sample_rate_off", "sample_rate_off", with_link(wrap_in<lying_link>(response_kind::byte))},
      {"frequency_off", "frequency_off", {}},
      {"motor_stuck", "motor_stuck",
       with_device([](auto& options) { options.standstill_ns = 60 * second; })},
      {"motor_unsteady", "motor_unsteady", with_device([](auto& options) {
         options.motor_drift_ppm = 100'000;
         options.motor_drift_period_ns = 700 * ms;
       })},
      {"protection_on", "protection_on",
       with_device([](auto& options) { options.initial.protection = power_down_protection::on; })},
      {"packets_lost", "packets_lost",
       with_device([](auto& options) { options.scanner.samples_per_packet = 10; })},
  };
  all[6].how.judged.frequency = scan_frequency::hz(10);
  return all;
}

class RunningScenario : public ::testing::TestWithParam<scenario> {};

TEST_P(RunningScenario, GetsItsOwnDiagnosis) {
  const seen found = watch(GetParam().how);
  EXPECT_EQ(found.diagnoses(), GetParam().diagnoses) << found;
}

INSTANTIATE_TEST_SUITE_P(All, RunningScenario, ::testing::ValuesIn(scenarios()),
                         [](const auto& one) { return std::string(one.param.name); });

// The lidar is back at 9 s, and scans again within 4 s: the window would be 10 s.
TEST(RunningDiagnosis, ALossIsOverWhenTheLidarIsBack) {
  use how;
  how.faults.push_back(std::get<sim::fault>(sim::parse_fault("unplug@8s+1s")));
  how.options.reconnect = true;
  how.seconds = 14;
  const seen found = watch(how);
  EXPECT_EQ(found.diagnoses(), "unplugged") << found;
  EXPECT_EQ(found.diagnoses(found.looks.size() - 1), "") << found;
  const stage_report& port = found.looks.back().front();
  EXPECT_EQ(port.stage, diagnostic_stage::port);
  EXPECT_EQ(port.outcome, stage_verdict::ok);
}

// Another lidar object opens it, and no scan is started: its answers show that it is there.
TEST(RunningDiagnosis, ALossIsOverWhenALidarAtRestAnswers) {
  using namespace std::chrono_literals;
  const std::vector<sim::fault> faults{std::get<sim::fault>(sim::parse_fault("unplug@2s+1s"))};
  sim::device simulated(sim::built_in_world(), {}, faults);
  sim::virtual_clock clock;
  running_diagnosis judge;
  const auto open = [&] {
    return lidar::open(judge.observe(std::make_unique<sim::virtual_connector>(simulated, clock)));
  };
  {
    auto device = open();
    ASSERT_TRUE(device && device->start());
    auto scan = device->try_scan(1s);
    while (scan || !scan.error().is_fatal()) scan = device->try_scan(1s);
    judge.add(scan.error());
  }
  EXPECT_EQ(judge.stages().front().outcome, stage_verdict::fail);
  clock.advance_to(4 * second);
  ASSERT_TRUE(open());
  EXPECT_EQ(judge.stages().front().outcome, stage_verdict::ok);
}

}  // namespace
