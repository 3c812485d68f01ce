// SPDX-License-Identifier: MIT
// Whether the samples in a stream have the size that is expected.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "g4lidar/core/layout_recogniser.hpp"

namespace g4lidar {

/// Of a stream whose samples have another size than expected.
struct stream_samples {
  std::size_t bytes = 0;      ///< Of a sample; 0: the size is as expected, or not certain.
  std::uint32_t rate_hz = 0;  ///< As the stream states it; 0: not.
  std::uint32_t frequency_chz =
      0;  ///< From which the rate follows. See layout_recogniser::frequency_chz().
};

/// *Single thread, never allocates.* From the begin of a stream on, until its first packets are as expected. The number
/// of a device may be that of another model: then no packet of the expected size is found.
class sample_size_watch {
 public:
  /// Samples of `expected` bytes.
  explicit sample_size_watch(std::size_t expected) noexcept : expected_(expected) {}

  /// Adds bytes of the stream, in order.
  void take(bytes input) noexcept {
    seen_.take(input);
    if (seen_.votes(expected_) == 0) return look_at_rate();
    fits_ += seen_.votes(expected_);
    seen_ = {};
    rate_ = {};
  }
  /// Whether the samples are as expected: nothing more needs to be taken.
  [[nodiscard]] bool is_settled() const noexcept { return fits_ >= enough; }
  /// Whether the samples have another size: by five packets in a row, and none of the expected size between them.
  [[nodiscard]] bool is_other() const noexcept {
    const std::size_t size = seen_.sample_bytes();
    return size != 0 && size != expected_ && seen_.votes(size) >= certain_packets;
  }
  /// The samples, if they have another size, and their rate is known, or not stated.
  [[nodiscard]] stream_samples other() const noexcept {
    if (!is_other()) return {};
    const std::size_t size = seen_.sample_bytes();
    const std::uint32_t packets = seen_.votes(size);
    const std::uint32_t hz = seen_.rate_hz();
    const std::uint32_t chz = seen_.frequency_chz();
    const bool is_steady = hz != 0 && packets > rate_.since + packets_of_turn(hz, chz);
    const bool is_unstated = hz == 0 && seen_.has_stated_all();
    if (!is_steady && !is_unstated && packets < most_packets) return {};
    return {size, hz, chz};
  }

 private:
  static constexpr std::uint32_t enough = 3;
  static constexpr std::uint32_t most_packets = 512;

  /// Of a revolution with such a stated rate and frequency, at least: with 40 samples each, as all models send.
  [[nodiscard]] static constexpr std::uint32_t packets_of_turn(std::uint32_t hz,
                                                               std::uint32_t chz) noexcept {
    constexpr std::uint32_t least = 16;
    return chz == 0 ? least : std::max(least, hz * 100 / chz / 40);
  }

  /// Notes since when the rate has been the same, nearly: while the motor spins up, it changes with each revolution.
  void look_at_rate() noexcept {
    const std::uint32_t hz = seen_.rate_hz();
    const std::uint32_t off = hz > rate_.hz ? hz - rate_.hz : rate_.hz - hz;
    if (16 * off > rate_.hz) rate_ = {hz, seen_.votes(seen_.sample_bytes())};
  }

  std::size_t expected_;
  std::uint32_t fits_ = 0;  // packets of the expected size that another one follows
  layout_recogniser seen_;  // since the last of them
  struct {
    std::uint32_t hz = 0;
    std::uint32_t since = 0;  // packets before it
  } rate_;
};

}  // namespace g4lidar
