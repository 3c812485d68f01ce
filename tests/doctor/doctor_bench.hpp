// SPDX-License-Identifier: MIT
// The doctor on a simulated device, in virtual time.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <ostream>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "doctor_exam.hpp"
#include "g4lidar/sim/virtual_port.hpp"
#include "g4lidar/sim/world.hpp"

namespace g4lidar::test {

/// How an examination has ended, and what it left behind.
struct examined {
  std::vector<g4_dump::stage_report> stages;
  double seconds = 0.0;
  bool motor_turns = false;
  sim::device_settings settings;

  /// The names of all diagnoses in the order of the stages: "was_scanning deaf".
  [[nodiscard]] std::string diagnoses() const {
    std::string text;
    for (const auto& stage : stages) {
      for (const auto what : stage.found) {
        text.append(text.empty() ? "" : " ").append(g4_dump::words_of(what).name);
      }
    }
    return text;
  }
  [[nodiscard]] int code() const { return static_cast<int>(g4_dump::exit_code_of(stages)); }
  [[nodiscard]] const g4_dump::stage_report& at(g4_dump::stage where) const {
    for (const auto& stage : stages) {
      if (stage.where == where) return stage;
    }
    return stages.back();
  }
};

/// All of it, for who reads why a test has failed.
inline std::ostream& operator<<(std::ostream& out, const examined& done) {
  for (const auto& stage : done.stages) {
    out << '\n' << g4_dump::name_of(stage.where) << ' ' << g4_dump::name_of(stage.how);
    for (const auto what : stage.found) out << ' ' << g4_dump::words_of(what).name;
    for (const auto& each : stage.facts) {
      out << ' ' << each.name << '=';
      std::visit([&out](const auto& value) { out << value; }, each.value);
    }
    out << ' ' << stage.remark;
  }
  return out << '\n' << done.seconds << " s, motor " << (done.motor_turns ? "turns" : "stands");
}

inline examined examine(const sim::device_options& options, std::span<const sim::fault> faults = {},
                        std::int64_t listen_ns = 5'000'000'000) {
  sim::device twin(sim::built_in_world(), options, faults);
  sim::virtual_clock clock;
  g4_dump::exam_options how;
  how.listen_ns = listen_ns;
  g4_dump::examination exam(std::make_unique<sim::virtual_port>(twin, clock), how, {});
  exam.run();
  examined done;
  done.stages = exam.stages();
  done.seconds = static_cast<double>(clock.now_ns()) / 1e9;
  static_cast<void>(twin.is_plugged(clock.now_ns()));
  done.motor_turns = twin.motor_turns();
  done.settings = twin.settings();
  return done;
}

/// Faults as they are written for g4-dump.
inline std::vector<sim::fault> faults_of(std::initializer_list<std::string_view> texts) {
  std::vector<sim::fault> faults;
  for (const std::string_view text : texts) {
    const auto read = sim::parse_fault(text);
    if (const auto* one = std::get_if<sim::fault>(&read)) faults.push_back(*one);
  }
  return faults;
}

}  // namespace g4lidar::test
