// SPDX-License-Identifier: MIT
// A port as a line of text and as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "g4lidar/discovery.hpp"

namespace g4_dump {

/// PATH, USB, ID, DRIVER, BRIDGE (g4, other, or - for what is no USB device), OPEN (yes, no), BY-ID.
/// What is not known is -; no cell has a blank in it.
[[nodiscard]] std::vector<std::string> port_cells(const g4lidar::port_info& port);

/// The names of these columns.
[[nodiscard]] std::vector<std::string> port_columns();

/// The same in an object, with what the bridge calls itself; what is not known is null.
[[nodiscard]] nlohmann::ordered_json port_object(const g4lidar::port_info& port);

/// A line: the cells, filled up with blanks to the widths, but for the last one.
[[nodiscard]] std::string line_of(const std::vector<std::string>& cells,
                                  const std::vector<std::size_t>& widths);

/// Widths that suit most ports, so that lines that come one by one stand below each other.
[[nodiscard]] std::vector<std::size_t> usual_port_widths();

}  // namespace g4_dump
