// SPDX-License-Identifier: MIT
// Diagnoses and counts as the statuses of a DiagnosticArray of ROS 2.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "g4lidar/background_reader.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "g4lidar/lidar_counts.hpp"
#include "g4lidar/message/diagnostic_array.hpp"

namespace g4lidar {

/// The status of a stage: warn and fail become warn and error, skipped becomes ok with its remark. Its
/// evidence is in `values`, the name of each diagnosis too. Allocates.
[[nodiscard]] G4LIDAR_API diagnostic_status status_of(const stage_report& stage,
                                                      std::string_view hardware_id);
/// "g4lidar: state": what a reader does, with its device and as which model that is read. An error where there is no
/// lidar; a warning where something contradicts the model. `why`: reader_status::why in words; empty: not an error, as
/// the end of a file. Allocates.
[[nodiscard]] G4LIDAR_API diagnostic_status status_of(const reader_status& now,
                                                      std::string_view why);
/// "g4lidar: counts" with all counts, level ok. Allocates.
[[nodiscard]] G4LIDAR_API diagnostic_status status_of(const lidar_counts& counts,
                                                      std::string_view hardware_id);
/// The statuses of all stages, then the counts. Allocates.
[[nodiscard]] G4LIDAR_API std::vector<diagnostic_status> statuses_of(
    std::span<const stage_report> stages, const lidar_counts& counts, std::string_view hardware_id);

}  // namespace g4lidar
