// SPDX-License-Identifier: MIT
// The time from a start of the motor to the first scan.
#pragma once

#include <cstdint>

namespace g4lidar {

/// *Single thread, never allocates.*
class spin_up {
 public:
  /// A loop over scans waits so long for the first one.
  static constexpr std::int64_t longest_ns = 10'000'000'000;

  /// The motor is started, when so many scans were complete. Starts that are repeated without a scan
  /// between them belong to one spin-up.
  void begin(std::int64_t ends_ns, std::uint64_t scans) noexcept {
    if (lasts(scans)) return;
    ends_ns_ = ends_ns;
    scans_ = scans;
  }
  /// The next start is not a repeated one.
  void forget() noexcept { ends_ns_ = 0; }
  /// Whether no scan was complete since the start.
  [[nodiscard]] bool lasts(std::uint64_t scans) const noexcept {
    return ends_ns_ != 0 && scans == scans_;
  }
  [[nodiscard]] std::int64_t ends_ns() const noexcept { return ends_ns_; }

 private:
  std::int64_t ends_ns_ = 0;
  std::uint64_t scans_ = 0;
};

}  // namespace g4lidar
