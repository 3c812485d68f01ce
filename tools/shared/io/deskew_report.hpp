// SPDX-License-Identifier: MIT
// Whether the motion is known by which points are deskewed: an event when it is not, and a status for /diagnostics.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>

#include "g4lidar/diagnostics/diagnostic_message.hpp"
#include "g4lidar/scan_shaper.hpp"

namespace g4_tool {

class deskew_report {
 public:
  /// `where`: odometry is expected, for deskewing by_path: "on /odom".
  deskew_report(g4lidar::deskewing how, const std::string& where);

  /// A scan of `points`, of which `outside` have no known motion. The event is reported when several scans had none at
  /// all, and again when the motion is known. *Single thread.*
  void add(std::size_t points, std::size_t outside);
  /// A warning if there were more such points since the last call. *Single thread*, another one.
  [[nodiscard]] g4lidar::diagnostic_status status();

 private:
  std::string hint_;
  bool is_missing_ = false;  // as it was reported
  int others_ = 0;           // so many scans in sequence were not as reported
  std::atomic<std::uint64_t> outside_ = 0;
  std::uint64_t outside_before_ = 0;
};

}  // namespace g4_tool
