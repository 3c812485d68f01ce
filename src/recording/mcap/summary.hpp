// SPDX-License-Identifier: MIT
// The summary at the end of a file that was closed.
#pragma once

#include <functional>

#include "chunk_source.hpp"
#include "record_text.hpp"

namespace g4lidar::mcap {

/// Calls `take` with the content of each channel in the summary, and of each metadata that its index names.
void read_summary(chunk_source& file, const std::function<void(opcode, field_reader)>& take);

}  // namespace g4lidar::mcap
