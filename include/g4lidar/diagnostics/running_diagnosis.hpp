// SPDX-License-Identifier: MIT
// Judges a lidar while a program uses it, from the bytes that the driver reads anyway.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <vector>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/filter.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/options/filter_text.hpp"
#include "g4lidar/settings.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar {

/// What is judged.
struct running_diagnosis_options {
  /// How much of the scan is judged: the last half of it to all of it; 1 s to 1 hour.
  std::chrono::nanoseconds window = std::chrono::seconds(10);
  /// What the lidar is set to, if it is known. Replies of the lidar that the driver reads replace it.
  std::optional<scan_frequency> frequency{};
  std::optional<g4lidar::sample_rate> sample_rate{};  ///< The same.
};

/// The judgement of diagnose(), continuously: the same stages, thresholds and diagnoses, over a sliding
/// window. It sends nothing and changes nothing. *Single thread*, that of the lidar, except stages().
/// Constant memory; about 40 instructions a sample, two thirds of what the driver needs.
/// (docs/design/doctor.md)
///
///     g4lidar::running_diagnosis judge;
///     auto from = g4lidar::connector_for(options);
///     auto lidar = g4lidar::lidar::open(judge.observe(std::move(*from)), options);
///     while (const auto event = lidar->next_event()) judge.add(*event);
///     for (const g4lidar::stage_report& stage : judge.stages()) show(stage);
class G4LIDAR_API running_diagnosis {
 public:
  /// Allocates all of its memory.
  explicit running_diagnosis(const running_diagnosis_options& options = {});
  ~running_diagnosis();
  running_diagnosis(const running_diagnosis&) = delete;
  running_diagnosis& operator=(const running_diagnosis&) = delete;

  /// A connector to the same device, not null, whose bytes are judged. This must outlive it. One lidar: a
  /// second connector is for the time after the first one. Scans that stop, pause and start again, and
  /// connections that are lost and return, begin a new window.
  [[nodiscard]] std::unique_ptr<connector> observe(std::unique_ptr<connector> from);

  /// What lidar::next_event() returned: its diagnosis is reported for the length of a window; that of
  /// `lost` until the lidar is back.
  void add(const lidar_event& what);
  /// The error that ended the use of the lidar: its diagnosis is reported until a scan runs again. Errors
  /// that are not fatal change nothing.
  void add(const error& why);

  /// The stages port, health, motor, stream, rate, loss, returns and usb_latency, in this order, and permission,
  /// holder, baud_rate, answers and identity if they have a diagnosis. `skipped` where nothing is known,
  /// with the reason as remark. `directions`: as diagnostic_options::directions. *Any thread.* Allocates.
  [[nodiscard]] std::vector<stage_report> stages(const point_filter& directions = {}) const;
  /// The same with those of filters, and what they ignore.
  [[nodiscard]] std::vector<stage_report> stages(const filter_settings& wanted) const;

 private:
  class state;
  std::unique_ptr<state> state_;
};

}  // namespace g4lidar
