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

/// `text` as a JSON string with its quotes; bytes that are not valid UTF-8 become U+FFFD. *Pure*,
/// allocates the result. (RFC 8259, section 7)
[[nodiscard]] G4LIDAR_API std::string json_string(std::string_view text);

}  // namespace g4lidar
