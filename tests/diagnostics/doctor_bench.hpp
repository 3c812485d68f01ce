// SPDX-License-Identifier: MIT
// The doctor on a simulated device, in virtual time.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <ostream>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "g4lidar/diagnostics/diagnosis.hpp"
#include "g4lidar/sim/virtual_port.hpp"
#include "g4lidar/sim/world.hpp"

namespace g4lidar::test {

using wrapper = std::function<std::unique_ptr<transport>(std::unique_ptr<transport>)>;

/// The result of a diagnostic run, and the state of the device after it.
struct examined {
  std::vector<stage_report> stages;
  std::vector<diagnostic_activity> activities;
  double seconds = 0.0;
  bool motor_turns = false;
  sim::device_settings settings;

  /// The names of all diagnoses in the order of the stages: "answers_late deaf".
  [[nodiscard]] std::string diagnoses() const {
    std::string text;
    for (const auto& stage : stages) {
      for (const auto what : stage.diagnoses) {
        text.append(text.empty() ? "" : " ").append(describe(what).name);
      }
    }
    return text;
  }
  [[nodiscard]] bool fails() const {
    return std::any_of(stages.begin(), stages.end(),
                       [](const auto& each) { return each.outcome == stage_verdict::fail; });
  }
  [[nodiscard]] const stage_report& at(diagnostic_stage where) const {
    for (const auto& stage : stages) {
      if (stage.stage == where) return stage;
    }
    return stages.back();
  }
};

/// Everything, for the message of a failed test.
inline std::ostream& operator<<(std::ostream& out, const examined& done) {
  for (const auto& stage : done.stages) {
    out << '\n' << name_of(stage.stage) << ' ' << name_of(stage.outcome);
    for (const auto what : stage.diagnoses) out << ' ' << describe(what).name;
    for (const auto& each : stage.measurements) {
      out << ' ' << each.name << '=';
      std::visit([&out](const auto& value) { out << value; }, each.value);
    }
    out << ' ' << stage.remark;
  }
  return out << '\n' << done.seconds << " s, motor " << (done.motor_turns ? "turns" : "stands");
}

/// A run with `simulated`, on a transport that `wrap` may wrap.
inline examined examine(sim::device& simulated, sim::virtual_clock& clock,
                        diagnostic_options how = {}, const wrapper& wrap = {}) {
  std::unique_ptr<transport> port = std::make_unique<sim::virtual_port>(simulated, clock);
  if (wrap) port = wrap(std::move(port));
  examined done;
  how.on_activity = [&](diagnostic_activity what) { done.activities.push_back(what); };
  done.stages = diagnose(std::move(port), how);
  done.seconds = static_cast<double>(clock.now_ns()) / 1e9;
  static_cast<void>(simulated.is_plugged(clock.now_ns() + 10'000'000));
  done.motor_turns = simulated.motor_turns();
  done.settings = simulated.settings();
  return done;
}

inline examined examine(const sim::device_options& options, std::span<const sim::fault> faults = {},
                        diagnostic_options how = {}) {
  sim::device simulated(sim::built_in_world(), options, faults);
  sim::virtual_clock clock;
  return examine(simulated, clock, std::move(how));
}

/// The names of all diagnoses in the table of faults.
std::string diagnoses_of_faults();
/// The same of the tests of the family.
std::string diagnoses_of_beliefs();

/// Faults in the format of g4-dump.
inline std::vector<sim::fault> faults_of(const std::vector<std::string_view>& texts) {
  std::vector<sim::fault> faults;
  for (const std::string_view text : texts) {
    const auto read = sim::parse_fault(text);
    if (const auto* one = std::get_if<sim::fault>(&read)) faults.push_back(*one);
  }
  return faults;
}

}  // namespace g4lidar::test
