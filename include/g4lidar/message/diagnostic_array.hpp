// SPDX-License-Identifier: MIT
// The diagnostic_msgs/msg/DiagnosticArray of ROS 2, in CDR. Does not need ROS.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/message/ros_messages.hpp"

namespace g4lidar {

/// The levels of a DiagnosticStatus.
enum class diagnostic_level : std::uint8_t { ok = 0, warn = 1, error = 2, stale = 3 };

/// One diagnostic_msgs/msg/DiagnosticStatus.
struct diagnostic_status {
  diagnostic_level level = diagnostic_level::ok;
  std::string name{};         ///< "g4lidar: rate".
  std::string message{};      ///< Cause and advice; "ok" where there is no diagnosis.
  std::string hardware_id{};  ///< The serial number of the lidar.
  std::vector<std::pair<std::string, std::string>> values{};  ///< Names with units, and values.
};

/// The schema of DiagnosticArray.
[[nodiscard]] G4LIDAR_API message_schema diagnostic_array_schema() noexcept;
/// Appends a diagnostic_msgs/msg/DiagnosticArray to `out`; `stamp_ns` is in nanoseconds since 1970.
/// Allocates beyond the capacity of `out`.
G4LIDAR_API void put_diagnostic_array(std::span<const diagnostic_status> statuses,
                                      std::int64_t stamp_ns, std::vector<std::uint8_t>& out);

}  // namespace g4lidar
