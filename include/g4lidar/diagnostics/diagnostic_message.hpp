// SPDX-License-Identifier: MIT
// Diagnoses and counts as the statuses of a DiagnosticArray of ROS 2.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "g4lidar/lidar_counts.hpp"
#include "g4lidar/message/diagnostic_array.hpp"

namespace g4lidar {

/// The status of a stage: warn and fail become warn and error, skipped becomes ok with its remark. Its
/// evidence is in `values`, the name of each diagnosis too. Allocates.
[[nodiscard]] G4LIDAR_API diagnostic_status status_of(const stage_report& stage,
                                                      std::string_view hardware_id);
/// "g4lidar: counts" with all counts, level ok. Allocates.
[[nodiscard]] G4LIDAR_API diagnostic_status status_of(const lidar_counts& counts,
                                                      std::string_view hardware_id);
/// The statuses of all stages, then the counts. Allocates.
[[nodiscard]] G4LIDAR_API std::vector<diagnostic_status> statuses_of(
    std::span<const stage_report> stages, const lidar_counts& counts, std::string_view hardware_id);

}  // namespace g4lidar
