// SPDX-License-Identifier: MIT
// Raw bytes, in a file or a pipe, as a line to a lidar: with times, so that they can be recorded.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "g4lidar/connector.hpp"
#include "g4lidar/error.hpp"

namespace g4_dump {

/// The file of that name, or standard input for `-`. What comes from a pipe, a device or a terminal has
/// come when it is read. A file on disk tells no times: its packets come as fast as their samples are
/// measured at `samples_per_second`, and its first one when the file was last written. Nothing answers.
[[nodiscard]] g4lidar::result<std::unique_ptr<g4lidar::connector>> open_byte_line(
    const std::string& name, std::uint32_t samples_per_second);

}  // namespace g4_dump
