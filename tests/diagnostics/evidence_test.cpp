// SPDX-License-Identifier: MIT
// The evidence and the verdict never contradict: each fault of the simulated device, alone, later, and with a lidar that
// was scanning; each verdict is compared with the numbers beside it, after docs/design/doctor.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "diagnostics/agreement.hpp"
#include "diagnostics/doctor_bench.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/sim/device_options.hpp"
#include "support/test_scale.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::test;

/// The kind alone, from 4 s on, and with a lidar that was scanning.
std::vector<std::vector<sim::fault>> faults_with(sim::fault_kind kind) {
  return {{sim::make_fault(kind)},
          {sim::make_fault(kind, 4'000'000'000)},
          {sim::make_fault(sim::fault_kind::scanning), sim::make_fault(kind)}};
}

class Evidence : public ::testing::TestWithParam<std::string_view> {};

TEST_P(Evidence, AgreesWithTheVerdict) {
  const model& real = *model_named(GetParam());
  auto run = static_cast<std::size_t>(*seeds(1).begin());
  for (std::size_t i = 0; i <= static_cast<std::size_t>(sim::last_fault_kind); ++i) {
    const auto kind = static_cast<sim::fault_kind>(i);
    for (const auto& faults : faults_with(kind)) {
      for (const bool is_named : {true, false}) {
        sim::device_options options;
        ASSERT_TRUE(sim::use_model(options, real.word));
        options.scanner.seed = ++run;
        sim::device simulated(sim::built_in_world(), options, faults);
        sim::virtual_clock clock;
        diagnostic_options how{.model = is_named ? &real : nullptr};
        how.measuring_time = std::chrono::seconds(2);
        const bool is_network = run % 3 == 0;
        std::unique_ptr<transport> port = std::make_unique<sim::virtual_port>(simulated, clock);
        static_cast<void>(port->set_baud(is_network || is_named ? real.bauds[0] : 230'400));
        if (is_network) port = std::make_unique<network_port>(std::move(port));
        examined done;
        done.stages = diagnose(std::move(port), how);
        const std::string name(sim::name_of(kind));
        SCOPED_TRACE(name + (faults.size() > 1 ? ", scanning" : "") +
                     (is_named ? ", named" : ", not named") + (is_network ? ", network" : ""));
        expect_agreement(done, real, is_network);
        if (HasFailure()) FAIL() << done;
      }
    }
  }
}

/// In the nightly all of them.
std::vector<std::string_view> examined_models() {
  const auto all = sim::model_words();
  if (test_scale() > 1) return {all.begin(), all.end()};
  return {"g4", "x4", "t-mini-pro", "x2", "tg30", "s2-intensity"};
}

INSTANTIATE_TEST_SUITE_P(Models, Evidence, ::testing::ValuesIn(examined_models()),
                         [](const auto& of) {
                           std::string name(of.param);
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

}  // namespace
