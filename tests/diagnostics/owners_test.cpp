// SPDX-License-Identifier: MIT
// The doctor with lidars whose speed is not that of their manuals, and that is set at a pin.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "diagnostics/doctor_bench.hpp"
#include "diagnostics/odd_links.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/sim/device_options.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::test;

sim::device_options device_of(std::string_view word) {
  sim::device_options options;
  EXPECT_TRUE(sim::use_model(options, word)) << word;
  return options;
}

/// The stage rate; of a lidar that is searched if `named` is empty.
stage_report rate_of(const sim::device_options& options, std::string_view named) {
  diagnostic_options how;
  how.model = model_named(named);
  sim::device simulated(sim::built_in_world(), options);
  sim::virtual_clock clock;
  std::unique_ptr<transport> port = std::make_unique<sim::virtual_port>(simulated, clock);
  EXPECT_TRUE(port->set_baud(230'400).value_or(false));
  examined done;
  done.stages = diagnose(std::move(port), how);
  return done.at(diagnostic_stage::rate);
}

/// An X2 with a speed that owners see and that its manual does not have.
sim::device_options x2_with(std::uint16_t rate_hz, std::uint16_t frequency_chz) {
  sim::device_options options = device_of("x2");
  options.scanner.format.rates_hz = {rate_hz, 0, 0};
  options.scanner.sample_rate = static_cast<sample_rate>(rate_hz);
  options.scanner.scan_frequency_chz = frequency_chz;
  options.scanner.format.max_frequency_chz =
      std::max(frequency_chz, options.scanner.format.max_frequency_chz);
  options.highest_frequency_chz = options.scanner.format.max_frequency_chz;
  return options;
}

// The rate to which the port happens to be set is not a measurement.
TEST(DoctorOfOwners, ALidarOfAnotherMakerHasNoMeasuredRate) {
  sim::device simulated(sim::built_in_world(), device_of("g4"));
  sim::virtual_clock clock;
  const examined done = examine(simulated, clock, {}, wrap_in<other_makers_link>());
  const stage_report& baud = done.at(diagnostic_stage::baud_rate);
  EXPECT_EQ(baud.outcome, stage_verdict::fail) << done;
  EXPECT_NE(baud.remark.find("an XV-11 of Neato"), std::string::npos) << done;
  for (const evidence& each : baud.measurements) EXPECT_NE(each.name, "baud") << done;
}

TEST(DoctorOfOwners, AnX2WithAnotherRate_IsThisX2) {
  for (const auto& [rate_hz, frequency_chz] :
       {std::pair(2500, 700), std::pair(2575, 1010), std::pair(3000, 1000), std::pair(3500, 1000),
        std::pair(3600, 400)}) {
    for (const char* const named : {"x2", ""}) {
      const stage_report rate = rate_of(
          x2_with(static_cast<std::uint16_t>(rate_hz), static_cast<std::uint16_t>(frequency_chz)),
          named);
      EXPECT_EQ(rate.outcome, stage_verdict::ok) << rate_hz;
      EXPECT_TRUE(rate.diagnoses.empty()) << rate_hz;
      if (rate_hz == 3000) continue;
      EXPECT_NE(rate.remark.find(" samples per second, 3000 by the manual"), std::string::npos)
          << rate.remark;
    }
  }
}

TEST(DoctorOfOwners, AnotherRateIsStillAnotherModel) {
  for (const std::uint16_t rate_hz :
       {std::uint16_t{2000}, std::uint16_t{4000}, std::uint16_t{5000}}) {
    const stage_report rate = rate_of(x2_with(rate_hz, 700), "x2");
    EXPECT_EQ(rate.diagnoses, std::vector{diagnosis::other_device}) << rate_hz;
  }
}

TEST(DoctorOfOwners, ThePinThatSetsTheSpeedIsNamed) {
  for (const auto& [word, pin] :
       {std::pair("x4", "M_SCTR"), std::pair("x2", "M_CTR"), std::pair("s2", "M_CTR")}) {
    const stage_report rate = rate_of(device_of(word), word);
    EXPECT_NE(rate.remark.find("a voltage or PWM at its pin"), std::string::npos) << rate.remark;
    EXPECT_NE(rate.remark.find(pin), std::string::npos) << rate.remark;
  }
  EXPECT_EQ(rate_of(device_of("g4"), "g4").remark, "");
}

}  // namespace
