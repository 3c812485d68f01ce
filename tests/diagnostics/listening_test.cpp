// SPDX-License-Identifier: MIT
// A diagnostic run that only listens.
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "diagnostics/agreement.hpp"
#include "diagnostics/doctor_bench.hpp"
#include "discovery/search_bench.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/sim/device_options.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::test;

struct heard {
  examined done;
  std::size_t written = 0;
};

heard listen_to(std::string_view word, const std::vector<sim::fault>& faults, bool is_named) {
  sim::device_options options;
  EXPECT_TRUE(sim::use_model(options, word)) << word;
  sim::device simulated(sim::built_in_world(), options, faults);
  sim::virtual_clock clock;
  diagnostic_options how{.model = is_named ? model_named(word) : nullptr, .listen_only = true};
  how.measuring_time = std::chrono::seconds(2);
  std::shared_ptr<const std::vector<std::string>> notes;
  heard all{examine(simulated, clock, how, [&](std::unique_ptr<transport> inner) {
    auto port = std::make_unique<noting_port>(std::move(inner));
    notes = port->shared_notes();
    return port;
  })};
  for (const std::string& each : *notes) all.written += each.starts_with("dtr=") ? 0U : 1U;
  return all;
}

TEST(DoctorListens, WritesNotAByte_WhateverHappens) {
  for (const char* const word : {"g4", "x4", "t-mini-plus", "x2", "s2-intensity"}) {
    const model& real = *model_named(word);
    for (std::size_t i = 0; i <= static_cast<std::size_t>(sim::last_fault_kind); ++i) {
      const auto kind = static_cast<sim::fault_kind>(i);
      for (const bool is_named : {false, true}) {
        const heard all = listen_to(
            word,
            {sim::make_fault(sim::fault_kind::scanning), sim::make_fault(kind, 3'000'000'000)},
            is_named);
        SCOPED_TRACE(std::string(word) + ", " + std::string(sim::name_of(kind)) +
                     (is_named ? ", named" : ""));
        EXPECT_EQ(all.written, 0U);
        expect_agreement(all.done, real, false);
        for (const char* const name : {"answers", "deaf", "was_scanning", "brown_out", "does_not"})
          EXPECT_EQ(all.done.diagnoses().find(name), std::string::npos) << name;
        if (HasFailure()) FAIL() << all.done;
      }
    }
  }
}

TEST(DoctorListens, TwoWayLidarThatScans_IsHealthy) {
  for (const std::string_view word : sim::model_words()) {
    // Its simulated motor stops: the line DTR is low until somebody opens the port.
    if (model_named(word)->motor == motor_kind::dtr) continue;
    const heard all = listen_to(word, faults_of({"scanning", "deaf"}), true);
    EXPECT_EQ(all.done.diagnoses(), "") << word << all.done;
    EXPECT_EQ(all.written, 0U) << word;
    EXPECT_EQ(all.done.at(diagnostic_stage::answers).outcome, stage_verdict::skipped);
    EXPECT_EQ(all.done.at(diagnostic_stage::loss).outcome, stage_verdict::ok);
  }
}

TEST(DoctorListens, LidarThatWaitsForACommand_IsSilent) {
  const heard all = listen_to("g4", {}, false);
  EXPECT_EQ(all.done.diagnoses(), "silent") << all.done;
  EXPECT_EQ(all.done.at(diagnostic_stage::answers).remark,
            "Nothing was sent: a lidar that waits for a command is silent.");
  EXPECT_EQ(all.written, 0U);
}

TEST(DoctorListens, PortThatOnlyAQuestionFinds_IsRefused) {
  examined done;
  done.stages = diagnose("serial:2021101000070073", {.listen_only = true});
  EXPECT_EQ(done.diagnoses(), "no_port") << done;
  EXPECT_NE(done.at(diagnostic_stage::port).remark.find("nothing is to be sent"), std::string::npos)
      << done;
}

}  // namespace
