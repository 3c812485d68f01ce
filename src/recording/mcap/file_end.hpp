// SPDX-License-Identifier: MIT
// The last chunks of a file, also of one that was cut off.
#pragma once

#include <cstdint>
#include <vector>

#include "chunk_source.hpp"

namespace g4lidar::mcap {

/// The offsets of up to eight of the last chunks, the last one first; by their headers only, so they may be damaged, or
/// no chunks. Reads not more of the file's end than it must.
[[nodiscard]] std::vector<std::uint64_t> last_chunks(byte_source& file);

}  // namespace g4lidar::mcap
