// SPDX-License-Identifier: MIT
// Bytes of a stream outside packets, responses and time packets: how many, and why.
#pragma once

#include <cstddef>
#include <cstdint>

#include "g4lidar/detail/cpp20.hpp"

namespace g4lidar {

/// Why bytes were skipped.
enum class skip_reason : std::uint8_t {
  noise,  ///< Nothing begins here: boot text, and the bytes that devices send before zero packets.
  bad_header,    ///< The start of a packet or response that is impossible.
  bad_checksum,  ///< A complete packet or time packet by its header; a byte is damaged or missing.
  truncated,     ///< A packet or response that was incomplete at the end.
};
/// The number of reasons for a skip.
inline constexpr std::size_t skip_reasons = 4;

/// Bytes of the stream outside packets, responses and time packets.
struct skipped {
  std::size_t count;
  skip_reason reason;
  std::uint8_t last = 0;  ///< The last of these bytes.

  friend constexpr bool operator==(const skipped&, const skipped&) = default;
};

/// The name of a reason in the tools. Valid forever.
[[nodiscard]] constexpr const char* name_of(skip_reason reason) noexcept {
  switch (reason) {
    case skip_reason::noise:
      return "noise";
    case skip_reason::bad_header:
      return "bad_header";
    case skip_reason::bad_checksum:
      return "bad_checksum";
    case skip_reason::truncated:
      break;
  }
  return "truncated";
}

}  // namespace g4lidar
