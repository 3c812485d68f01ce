// SPDX-License-Identifier: MIT
// Makes text from a device or a file safe for a terminal or a log.
#pragma once

#include <string>
#include <string_view>

#include "g4lidar/detail/api.hpp"

namespace g4lidar {

/// `text` as one line without control characters: printable ASCII and other characters of valid
/// UTF-8 unchanged, a backslash as `\\`, each other byte (control characters, C1 controls, invalid
/// UTF-8) as `\x1B`. The result contains no byte that a terminal interprets. *Pure*, allocates the
/// result.
[[nodiscard]] G4LIDAR_API std::string printable(std::string_view text);

}  // namespace g4lidar
