// SPDX-License-Identifier: MIT
// Whether there is odometry for deskewing: an event when it is missing, and a status for /diagnostics.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>

#include "g4lidar/diagnostics/diagnostic_message.hpp"

namespace g4_tool {

class deskew_report {
 public:
  /// `where`: odometry is expected: "on /odom".
  explicit deskew_report(const std::string& where);

  /// A scan of `points`, of which `outside` had no odometry. The event is reported when several scans had none at all,
  /// and again when odometry comes. *Single thread.*
  void add(std::size_t points, std::size_t outside);
  /// A warning if there were more points without odometry since the last call. *Single thread*, another one.
  [[nodiscard]] g4lidar::diagnostic_status status();

 private:
  std::string hint_;
  bool is_missing_ = false;  // as it was reported
  int others_ = 0;           // so many scans in sequence were not as reported
  std::atomic<std::uint64_t> outside_ = 0;
  std::uint64_t outside_before_ = 0;
};

}  // namespace g4_tool
