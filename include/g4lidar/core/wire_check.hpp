// SPDX-License-Identifier: MIT
// The result of checking bytes that begin like a packet or a response.
#pragma once

#include <cstddef>
#include <cstdint>

#include "g4lidar/detail/cpp20.hpp"

namespace g4lidar {

/// How far the available bytes decide whether they begin with a packet or response.
enum class wire_state : std::uint8_t {
  valid,         ///< A complete packet or response that passes all checks.
  incomplete,    ///< No contradiction yet; more bytes are needed to decide.
  bad_header,    ///< The header or an impossible content excludes both.
  bad_checksum,  ///< A complete packet by its header, but its checksum does not match.
};

/// The result for one front. More bytes behind it change only the result `incomplete`.
struct wire_check {
  wire_state state;
  /// valid: the size of the packet or response. incomplete: with fewer bytes than this the result
  /// stays `incomplete` (always more than are available). bad_header, bad_checksum: the number of
  /// bytes that the refused header claimed.
  std::size_t size;

  friend constexpr bool operator==(const wire_check&, const wire_check&) = default;
};

}  // namespace g4lidar
