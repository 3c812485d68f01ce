// SPDX-License-Identifier: MIT
// The rule of a loop over the scans of a lidar: how long it waits, and what ends it.
#pragma once

#include <cstdint>
#include <optional>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/scan.hpp"

namespace g4lidar {

/// A loop over scans that waits in slices, because it also does other things: the rule of lidar::wait_scan(), which is
/// one such wait. *Single thread*: that of the lidar.
class G4LIDAR_API scan_loop {
 public:
  /// `timeout`: for each scan, as soon as it is due.
  explicit scan_loop(lidar::milliseconds timeout) noexcept : timeout_(timeout) {}

  /// Waits at most `slice` for the next scan; valid as that of lidar::wait_scan(). Nothing: none has come, and the loop
  /// goes on. Errors, which end the loop: as lidar::wait_scan(). After cancelled the next call continues the same wait.
  [[nodiscard]] result<std::optional<scan>> wait(lidar& source, lidar::milliseconds slice);
  /// How long from now a wait for the next scan can last; milliseconds::max() without limit.
  [[nodiscard]] lidar::milliseconds left(const lidar& from) const noexcept;

 private:
  lidar::milliseconds timeout_;
  std::optional<std::int64_t> deadline_ns_;  // of the next scan, by the clock of timeouts
};

}  // namespace g4lidar
