// SPDX-License-Identifier: MIT
// How values are written: the format, the unit and the time.
#pragma once

#include <cstdint>

namespace g4_tool {

/// The format of the text.
enum class text_format : std::uint8_t {
  csv,    ///< Comma-separated values, RFC 4180 with line feeds as line ends.
  jsonl,  ///< One JSON object per line.
  text,   ///< Columns for people; they may change.
};

/// The unit of ranges.
enum class length_unit : std::uint8_t { millimetres, metres };

/// Which time is written.
enum class time_style : std::uint8_t {
  absolute,   ///< Nanoseconds since 1970, by the wall clock.
  monotonic,  ///< Nanoseconds of the monotonic clock, as in point::time_ns.
  delta,      ///< Nanoseconds since the previous record.
  zero,       ///< Nanoseconds since the first record.
};

}  // namespace g4_tool
