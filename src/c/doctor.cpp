// SPDX-License-Identifier: MIT
#include <g4lidar/c/doctor.h>

#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "border.hpp"
#include "g4lidar/diagnostics/diagnostic_run.hpp"
#include "g4lidar/recording/reader.hpp"
#include "simulation.hpp"

namespace g4lidar::c {

static_assert(static_cast<int>(stage_verdict::fail) == G4LIDAR_VERDICT_FAIL);

/// A stage as C sees it. Its texts are views of the report, of these members, and of literals.
class shown_stage {
 public:
  explicit shown_stage(const stage_report& from) {
    for (const diagnosis each : from.diagnoses) {
      const diagnosis_info about = describe(each);
      diagnoses_.push_back({literal(about.name), literal(about.cause), literal(about.advice),
                            static_cast<std::int32_t>(about.severity), 0});
    }
    texts_.reserve(from.measurements.size());
    for (const evidence& each : from.measurements) {
      g4lidar_evidence made{each.name.c_str(),
                            literal(each.unit()),
                            texts_.emplace_back(each.text()).c_str(),
                            0,
                            0.0,
                            G4LIDAR_VALUE_TEXT,
                            0};
      if (const auto* number = std::get_if<std::int64_t>(&each.value)) {
        made.kind = G4LIDAR_VALUE_INTEGER;
        made.integer = *number;
        made.real = static_cast<double>(*number);
      } else if (const auto* real = std::get_if<double>(&each.value)) {
        made.kind = G4LIDAR_VALUE_REAL;
        made.real = *real;
      }
      evidence_.push_back(made);
    }
    stage_ = {.name = literal(name_of(from.stage)),
              .remark = from.remark.c_str(),
              .diagnoses = diagnoses_.data(),
              .diagnosis_count = diagnoses_.size(),
              .evidence = evidence_.data(),
              .evidence_count = evidence_.size(),
              .verdict = static_cast<std::int32_t>(from.outcome)};
  }
  [[nodiscard]] const g4lidar_stage& stage() const noexcept { return stage_; }

 private:
  std::vector<g4lidar_diagnosis> diagnoses_;
  std::vector<std::string> texts_;
  std::vector<g4lidar_evidence> evidence_;
  g4lidar_stage stage_{};
};

}  // namespace g4lidar::c

using namespace g4lidar;
using namespace g4lidar::c;

struct g4lidar_report {
  std::vector<stage_report> stages;
  std::vector<std::unique_ptr<const shown_stage>> shown;
};

namespace {

constexpr g4lidar_doctor_options doctor_defaults{
    sizeof(g4lidar_doctor_options), 5'000'000'000, nullptr, nullptr, nullptr, 0, {}, nullptr};

/// Runs `examine` with the options, and makes a report of its stages.
template <class Examine, class... Pointers>
int examined(const g4lidar_doctor_options* given, g4lidar_report** report, g4lidar_error* error,
             Examine examine, Pointers... needed) noexcept {
  return created(
      report, error,
      [&]() -> int {
        g4lidar_doctor_options taken = doctor_defaults;
        if (!take_options(given, taken)) return refuse(error, bad_options);
        if (taken.measuring_time_ns < 0) return bad_option(error, "measuring_time_ns: from 0 on");
        diagnostic_options options;
        options.baud = taken.baud;
        if (!take_model(taken.model, options.model)) return refuse_model(error, taken.model);
        options.measuring_time = std::chrono::nanoseconds(taken.measuring_time_ns);
        options.is_cancelled = question_of(taken);
        if (taken.on_stage != nullptr) {
          options.on_stage = [&taken](const stage_report& done) {
            taken.on_stage(&shown_stage(done).stage(), taken.context);
          };
        }
        auto made = std::make_unique<g4lidar_report>();
        if (const int code = examine(options, made->stages); code != G4LIDAR_OK) return code;
        for (const stage_report& each : made->stages) {
          made->shown.push_back(std::make_unique<const shown_stage>(each));
        }
        *report = made.release();
        return succeed(error);
      },
      needed...);
}

void diagnose_simulated(simulation& simulated, const diagnostic_options& options,
                        std::vector<stage_report>& stages) {
  if (const auto from = simulated.connect()) {
    stages = diagnose(*from, options);
  } else {
    stages = diagnose(simulated.path(), options);
  }
}

}  // namespace

void g4lidar_doctor_options_init(g4lidar_doctor_options* options, size_t size) {
  set_defaults(options, size, doctor_defaults);
}

int g4lidar_diagnose(const char* source, const g4lidar_doctor_options* options,
                     g4lidar_report** report, g4lidar_error* error) {
  return examined(options, report, error,
                  [&](const diagnostic_options& how, std::vector<stage_report>& stages) -> int {
                    stages = diagnose(text_of(source), how);
                    return G4LIDAR_OK;
                  });
}

int g4lidar_diagnose_simulated(g4lidar_simulator* simulator, const g4lidar_doctor_options* options,
                               g4lidar_report** report, g4lidar_error* error) {
  return examined(
      options, report, error,
      [&](const diagnostic_options& how, std::vector<stage_report>& stages) -> int {
        diagnose_simulated(*simulator->made, how, stages);
        return G4LIDAR_OK;
      },
      simulator);
}

size_t g4lidar_report_count(const g4lidar_report* report) {
  return report == nullptr ? 0 : report->shown.size();
}

const g4lidar_stage* g4lidar_report_at(const g4lidar_report* report, size_t index) {
  return index < g4lidar_report_count(report) ? &report->shown[index]->stage() : nullptr;
}

void g4lidar_report_free(g4lidar_report* report) { delete report; }
