// SPDX-License-Identifier: MIT
// Small files of text that people write.
#pragma once

#include <string>

namespace g4lidar {

/// Reads the whole file: why not, or empty: "is a directory". Never waits: a pipe or a device is refused, as a file of
/// more than 16 MiB is. Throws only std::bad_alloc.
[[nodiscard]] std::string read_text_file(const std::string& path, std::string& text);

}  // namespace g4lidar
