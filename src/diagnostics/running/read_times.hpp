// SPDX-License-Identifier: MIT
// What the calls of a driver on its transport show: how long nothing arrived, and how long the program did
// not read.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "diagnostics/link_monitor.hpp"

namespace g4lidar {

/// *Single thread, never allocates.* Pauses of the driver and of the program are not silence of the device,
/// unless nothing has arrived at their end.
class read_times {
 public:
  void reset(std::int64_t now_ns) noexcept {
    *this = {};
    end_ns_ = now_ns;
  }

  /// The driver let bytes accumulate.
  void paused(std::int64_t begin_ns, std::int64_t until_ns, std::int64_t end_ns) noexcept {
    follow(begin_ns);
    (is_late(begin_ns, until_ns, end_ns) ? host_pause_ns_ : unread_ns_) += end_ns - begin_ns;
    has_backlog_ = true;
    end_ns_ = end_ns;
  }

  /// A read waited; `count` bytes came.
  void waited(std::int64_t begin_ns, std::int64_t until_ns, std::int64_t end_ns,
              std::size_t count) noexcept {
    follow(begin_ns);
    const bool is_paused = is_late(begin_ns, until_ns, end_ns);
    has_backlog_ = has_backlog_ || is_paused;
    if (is_paused) {
      host_pause_ns_ += end_ns - begin_ns;
    } else if (count == 0 || !has_backlog_) {
      silence_ns_ += end_ns - begin_ns;
    }
    if (count == 0) {
      silence_ns_ += std::exchange(unread_ns_, 0) + std::exchange(absence_ns_, 0);
      has_backlog_ = false;
    }
    end_ns_ = end_ns;
  }

  /// What is known about the bytes that came. `is_full`: more may be waiting.
  [[nodiscard]] timed_read take(std::size_t count, std::int64_t arrival_ns, bool is_full) noexcept {
    // A program that did not look for bytes finds them; where there are none, the device was silent.
    const auto expected = static_cast<std::size_t>(absence_ns_ / ms) * least_bytes_per_ms;
    const bool is_of_host = count >= std::min(expected, few_bytes);
    (is_of_host ? host_pause_ns_ : silence_ns_) += std::exchange(absence_ns_, 0);
    unread_ns_ = 0;
    const timed_read what{count, arrival_ns, std::exchange(silence_ns_, 0),
                          std::exchange(host_pause_ns_, 0), has_backlog_};
    has_backlog_ = has_backlog_ && is_full;
    return what;
  }

  /// How long nothing has arrived.
  [[nodiscard]] std::int64_t silence_ns() const noexcept { return silence_ns_; }

 private:
  /// A program that does not call for this time lets bytes accumulate.
  static constexpr std::int64_t idle_ns = 1 * ms;
  /// Half of what the slowest models send: 3000 samples of 2 bytes a second, and the headers of packets.
  static constexpr std::size_t least_bytes_per_ms = 3;
  static constexpr std::size_t few_bytes = 1024;

  [[nodiscard]] static bool is_late(std::int64_t begin_ns, std::int64_t until_ns,
                                    std::int64_t end_ns) noexcept {
    return end_ns - std::max(begin_ns, until_ns) > host_pause_after_ns;
  }
  /// The time between two calls.
  void follow(std::int64_t begin_ns) noexcept {
    const std::int64_t between_ns = begin_ns - end_ns_;
    has_backlog_ = has_backlog_ || between_ns > idle_ns;
    if (between_ns > longest_read_ns + host_pause_after_ns) absence_ns_ += between_ns;
  }

  std::int64_t end_ns_ = 0;         // of the last call
  std::int64_t silence_ns_ = 0;     // since the last bytes, while the program was waiting
  std::int64_t unread_ns_ = 0;      // pauses of the driver since the last read
  std::int64_t absence_ns_ = 0;     // long times between calls since the last read
  std::int64_t host_pause_ns_ = 0;  // since the last bytes
  bool has_backlog_ = false;        // bytes may have been waiting before the read
};

}  // namespace g4lidar
