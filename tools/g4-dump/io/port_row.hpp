// SPDX-License-Identifier: MIT
// A port as a line of text and as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "g4lidar/discovery.hpp"

namespace g4_tool {

/// PATH, USB, ID, DRIVER, BRIDGE (g4, other; - if it is not a USB device), OPEN (yes, no), BY-ID.
/// Unknown values are -; no cell contains a blank.
[[nodiscard]] std::vector<std::string> port_cells(const g4lidar::port_info& port);

/// The names of these columns.
[[nodiscard]] std::vector<std::string> port_columns();

/// The same as an object, with the names that the bridge reports; unknown values are null.
[[nodiscard]] nlohmann::ordered_json port_object(const g4lidar::port_info& port);

/// A line of cells. All but the last one are padded with blanks to their widths.
[[nodiscard]] std::string line_of(const std::vector<std::string>& cells,
                                  const std::vector<std::size_t>& widths);

}  // namespace g4_tool
