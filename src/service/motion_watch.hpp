// SPDX-License-Identifier: MIT
// Whether the motion is known by which points are deskewed: a change of it, and a status for /diagnostics.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "g4lidar/message/ros_messages.hpp"
#include "g4lidar/scan_shaper.hpp"

namespace g4lidar {

class motion_watch {
 public:
  /// `where`: odometry is expected, for deskewing by_path: "on /odom".
  motion_watch(deskewing deskew, const std::string& where);

  /// A scan of `points`, of which `outside` have no known motion. False when several scans in sequence had none at all,
  /// and true when the motion is known again; else nothing. *Single thread.*
  [[nodiscard]] std::optional<bool> add(std::size_t points, std::size_t outside);
  /// Why points are not deskewed, for people.
  [[nodiscard]] const std::string& hint() const noexcept { return hint_; }
  /// A warning if there were more such points since the last call. *Single thread*, another one.
  [[nodiscard]] diagnostic_status status();

 private:
  std::string hint_;
  bool is_missing_ = false;  // as it was returned
  int others_ = 0;           // so many scans in sequence were not as returned
  std::atomic<std::uint64_t> outside_ = 0;
  std::uint64_t outside_before_ = 0;
};

}  // namespace g4lidar
