// SPDX-License-Identifier: MIT
// Examines a lidar, its connection, its port, or a file of its bytes.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "g4lidar/filter.hpp"
#include "g4lidar/transport/connector.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar {

/// The current activity of a diagnostic run.
enum class diagnostic_activity : std::uint8_t {
  listening,    ///< Bytes that arrive without a query.
  asking,       ///< All queries, several times.
  searching,    ///< All baud rates, for a lidar that was not found at the first one; up to 6 s.
  starting,     ///< The start command was sent.
  spinning_up,  ///< The lidar has accepted the start command and has sent no packet yet; up to 10 s.
  measuring,    ///< The running scan.
};

/// Options and callbacks of a diagnostic run. The callbacks may be empty.
struct diagnostic_options {
  std::uint32_t baud = 0;  ///< Bits per second; 0: those of the model, or as search() finds them.
  /// The model that is expected. Null: of a device the one that its replies or its bytes show, as
  /// search() finds it; of a file what a recording states, or the raw bytes show, as
  /// model_of_source() finds it. Valid forever.
  const g4lidar::model* model = nullptr;
  bool insist_on_model = false;  ///< As that of lidar_options: whatever number the lidar reports.
  /// As that of lidar_options: not a byte is sent. What needs answers is skipped, and a lidar that waits for a command
  /// is silent. Where the source has no name, there must be one port with the bridge of a G4.
  bool listen_only = false;
  bool probe_all_ports = false;  ///< As that of lidar_options, where the source has no name.
  /// How long to measure the running scan; a file is always read completely.
  std::chrono::nanoseconds measuring_time = std::chrono::seconds(5);
  /// The directions that the user wants: its field_of_view and ignored_sectors, in its frame, for the model that is
  /// found. Of what lies outside of them the stage returns reports nothing. The sectors must outlive the run.
  point_filter directions{};
  /// Called about 20 times a second; returning true ends the run. The lidar is stopped then, too.
  std::function<bool()> is_cancelled{};
  /// Called with each stage when it ends, also with stages that are skipped.
  std::function<void(const stage_report&)> on_stage{};
  /// Called when the run begins to wait for something.
  std::function<void(diagnostic_activity)> on_activity{};
};

/// Executes all stages and returns their reports, for the `source` of this name (source.hpp). Stages that
/// need a device are skipped for a file.
///
/// Takes about 3 s plus `measuring_time` with a healthy lidar, 8 s if it has to be searched, and at most
/// 45 s plus `measuring_time` with one fault, if answers are at most 4 s late. Sends queries, starts,
/// and stops; as long as nothing has answered and no model is named, only the question for the device
/// information. To a model without commands none but two bytes while it is searched. Changes no setting;
/// the motor is stopped at the end, if it can be. *Allocates. Single thread.*
[[nodiscard]] G4LIDAR_API std::vector<stage_report> diagnose(
    std::string_view source, const diagnostic_options& options = {});

/// The same for an open transport: the stages from baud_rate on.
[[nodiscard]] G4LIDAR_API std::vector<stage_report> diagnose(
    std::unique_ptr<transport> opened, const diagnostic_options& options = {});

/// The same for the transports of `connector`. If it fails to connect, the first stages report that.
[[nodiscard]] G4LIDAR_API std::vector<stage_report> diagnose(
    connector& connector, const diagnostic_options& options = {});

}  // namespace g4lidar
