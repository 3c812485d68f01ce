// SPDX-License-Identifier: MIT
// Distinguishes packets that the host delayed from packets whose predecessors were lost unnoticed.
#pragma once

#include <cstdint>

#include "g4lidar/detail/cpp20.hpp"
#include "g4lidar/detail/saturating.hpp"

namespace g4lidar {

/// The run of packets that are too late for the count of samples. *Single thread, never allocates.*
/// After a suspension of the program the packets become less and less late, unless it is suspended
/// again. If they stay late, samples were lost without being counted.
class late_packets {
 public:
  /// A packet that is later than this was delayed by more than batching.
  static constexpr double late_ns = 25e6;

  /// Bytes were skipped: a loss nearly always damages a packet.
  constexpr void skipped() noexcept { is_torn_ = true; }
  /// Forgets what was seen, at the beginning of a stream.
  constexpr void reset() noexcept { is_late_ = is_torn_ = false; }

  /// Whether the last packet was too late.
  [[nodiscard]] constexpr bool is_late() const noexcept { return is_late_; }

  /// The next packet, measured at `time_ns`, is later than expected by `delay_ns`; `is_late`: by too
  /// much. Returns whether packets have been too late for too long.
  [[nodiscard]] constexpr bool add(bool is_late, double delay_ns, std::int64_t time_ns) noexcept {
    const bool was_late = is_late_;
    is_late_ = is_late;
    if (!is_late_) {
      is_torn_ = false;
      return false;
    }
    if (!was_late || delay_ns < least_ns_ - catching_up_ns) {
      least_ns_ = delay_ns;
      since_ns_ = steady_since_ns_ = time_ns;
    }
    if (delay_ns > least_ns_ + late_ns) steady_since_ns_ = time_ns;
    const auto late_for_ns = static_cast<double>(detail::saturating_sub(time_ns, since_ns_));
    const auto steady_for_ns =
        static_cast<double>(detail::saturating_sub(time_ns, steady_since_ns_));
    return (is_torn_ && steady_for_ns > all_late_ns) || late_for_ns > surely_late_ns;
  }

 private:
  /// The time without a packet in time, and without a decrease of the delay by this much, after which
  /// samples were lost without being counted.
  static constexpr double all_late_ns = 40e6;
  static constexpr double catching_up_ns = 5e6;
  /// The same if no byte was skipped.
  static constexpr double surely_late_ns = 1e9;

  bool is_late_ = false;
  bool is_torn_ = false;              // bytes were skipped since the last packet in time
  double least_ns_ = 0.0;             // the least delay of the run
  std::int64_t since_ns_ = 0;         // late since then, without a decrease
  std::int64_t steady_since_ns_ = 0;  // without a further delay since then
};

}  // namespace g4lidar
