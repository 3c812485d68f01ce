// SPDX-License-Identifier: MIT
// Whether the samples in a stream have the size that is expected.
#pragma once

#include <cstddef>
#include <cstdint>

#include "g4lidar/core/layout_recogniser.hpp"

namespace g4lidar {

/// *Single thread, never allocates.* From the begin of a stream on, until its first packets are as expected. The number
/// of a device may be that of another model: then no packet of the expected size is found.
class sample_size_watch {
 public:
  /// Samples of `expected` bytes.
  explicit sample_size_watch(std::size_t expected) noexcept : expected_(expected) {}

  /// Adds bytes of the stream, in order.
  void take(bytes input) noexcept {
    seen_.take(input);
    if (seen_.votes(expected_) == 0) return;
    fits_ += seen_.votes(expected_);
    seen_ = {};
  }
  /// Whether the samples are as expected: nothing more needs to be taken.
  [[nodiscard]] bool is_settled() const noexcept { return fits_ >= enough; }
  /// The size of the samples, if it is another one: by five packets in a row, and none of the expected size between
  /// them; else 0.
  [[nodiscard]] std::size_t other() const noexcept {
    const std::size_t size = seen_.sample_bytes();
    return size != 0 && size != expected_ && seen_.votes(size) >= certain_packets ? size : 0;
  }

 private:
  static constexpr std::uint32_t enough = 3;

  std::size_t expected_;
  std::uint32_t fits_ = 0;  // packets of the expected size that another one follows
  layout_recogniser seen_;  // since the last of them
};

}  // namespace g4lidar
