// SPDX-License-Identifier: MIT
// The first bytes of a pipe, held back until it is known which model sends them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/core/layout_recogniser.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/detail/saturating.hpp"

namespace g4lidar {

/// What sends bytes, and how this is known.
struct recognised_model {
  const model* which = &g4_model;  ///< Valid forever.
  recognised_by basis = recognised_by::nothing;
  std::uint32_t rate_hz = 0;        ///< Samples per second, as measured; 0: not known.
  std::uint32_t frequency_dhz = 0;  ///< From which the rate follows. See may_measure().

  /// Whether other models send such bytes, too.
  [[nodiscard]] constexpr bool is_usual() const noexcept {
    return basis == recognised_by::size || basis == recognised_by::flags;
  }
};

/// Whether `data` begins as a recording does. *Pure.*
[[nodiscard]] constexpr bool begins_recording(bytes data) noexcept {
  constexpr std::array<std::uint8_t, 8> magic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
  return data.size() >= magic.size() && std::equal(magic.begin(), magic.end(), data.begin());
}

/// Holds bytes that cannot be read again until layout_recogniser has recognised their model. It is
/// complete when the bytes name the model, 1 s after the first packet, after 10 s without a packet, or
/// with 64 KiB; with 1 MiB as long as the size of a sample is not decided; and at once for a recording.
/// *Single thread.* Allocates.
class stream_head {
 public:
  /// Begins at `now_ns`, by any clock.
  explicit stream_head(std::int64_t now_ns) noexcept
      : due_ns_(detail::saturating_add(now_ns, longest_silence_ns)) {}

  /// Adds bytes that were read at `now_ns`.
  void take(bytes data, std::int64_t now_ns) {
    held_.insert(held_.end(), data.begin(), data.end());
    seen_.take(data);
    if (has_packet_ || !seen_.has_packet()) return;
    has_packet_ = true;
    due_ns_ = detail::saturating_add(now_ns, longest_wait_ns);
  }
  /// The input has ended, or nobody waits any longer.
  void finish() noexcept {
    seen_.finish();
    is_finished_ = true;
  }

  /// Whether nothing more needs to be held back.
  [[nodiscard]] bool is_complete(std::int64_t now_ns) const noexcept {
    if (is_finished_ || now_ns >= due_ns_ || begins_recording(held_)) return true;
    if (seen_.sample_bytes() == 0) return held_.size() >= most_undecided;
    return held_.size() >= enough || seen_.basis() == recognised_by::number;
  }
  /// When it is complete even if nothing arrives.
  [[nodiscard]] std::int64_t due_ns() const noexcept { return due_ns_; }
  /// All bytes that were added. Valid until the next call.
  [[nodiscard]] bytes held() const noexcept { return held_; }
  /// What sends them, as far as they show it: if it is complete and not decided, as if they ended here.
  [[nodiscard]] recognised_model found() const noexcept {
    if (seen_.sample_bytes() != 0 || begins_recording(held_)) {
      return {&seen_.most_likely(), seen_.basis(), seen_.rate_hz(), seen_.frequency_dhz()};
    }
    layout_recogniser ended = seen_;
    ended.finish();
    return {&ended.most_likely(), ended.basis(), ended.rate_hz(), ended.frequency_dhz()};
  }

 private:
  static constexpr std::int64_t longest_wait_ns = 1'000'000'000;
  static constexpr std::int64_t longest_silence_ns = 10'000'000'000;
  static constexpr std::size_t enough = std::size_t{64} << 10U;
  static constexpr std::size_t most_undecided = std::size_t{1} << 20U;

  layout_recogniser seen_;
  std::vector<std::uint8_t> held_;
  std::int64_t due_ns_;
  bool has_packet_ = false;
  bool is_finished_ = false;
};

}  // namespace g4lidar
