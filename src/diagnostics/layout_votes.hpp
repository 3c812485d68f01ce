// SPDX-License-Identifier: MIT
// How many bytes a sample of these packets has: other models of the maker send the same packets with
// samples of 3 or 4 bytes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "g4lidar/core/bytes.hpp"

namespace g4lidar {

/// Counts the frames whose checksum fits with samples of 2, 3 and 4 bytes, and behind which another
/// frame begins. The right size fits each of them, a wrong one few. *Single thread.*
class layout_votes {
 public:
  void take(bytes input);
  /// The input has ended: a frame at its end counts, too.
  void finish();
  /// 2, 3 or 4; 0 as long as none has a lead of three frames.
  [[nodiscard]] std::size_t sample_bytes() const noexcept;

 private:
  void look_at(bytes frame);

  std::vector<std::uint8_t> held_;        // less than the largest frame with what is behind it
  std::array<std::uint64_t, 5> votes_{};  // by the bytes of a sample
};

}  // namespace g4lidar
