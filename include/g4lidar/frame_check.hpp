// SPDX-License-Identifier: MIT
// What can be said of bytes that begin like a frame: the common answer of packet and response.
#pragma once

#include <cstddef>
#include <cstdint>

namespace g4lidar {

/// How far the bytes in hand decide whether a frame stands at their front.
enum class frame_state : std::uint8_t {
  valid,         ///< A whole frame that may be believed.
  incomplete,    ///< Nothing speaks against a frame yet; more bytes are needed to tell.
  bad_header,    ///< The header, or a content that is not possible, rules a frame out.
  bad_checksum,  ///< A whole packet by its header, but its checksum disagrees.
};

/// The answer for one front. More bytes behind it never change an answer other than `incomplete`.
struct frame_check {
  frame_state state;
  /// valid: the bytes of the frame. incomplete: with fewer bytes than this the answer stays
  /// `incomplete` (always more than are in hand). bad_header, bad_checksum: the bytes that the
  /// refused frame had laid claim to.
  std::size_t size;

  friend constexpr bool operator==(const frame_check&, const frame_check&) = default;
};

}  // namespace g4lidar
