// SPDX-License-Identifier: MIT
// Texts about names of ports: which one was meant, and which ports were not looked at.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "g4lidar/discovery.hpp"
#include "transport/tcp_port.hpp"

namespace g4lidar {

inline constexpr std::string_view serial_prefix = "serial:";
inline constexpr std::string_view usb_prefix = "usb:";

/// The name that is meant by one that names nothing: "/dev/ttyUSB0" by "ttyUSB0", "tcp:HOST:4000" by "udp:HOST:4000";
/// empty if it is not known. Looks whether there is a file of this name. *Allocates.*
[[nodiscard]] std::string meant_by(std::string_view given);

/// The error for such a name; nothing for any other. *Allocates.*
[[nodiscard]] std::optional<error> misspelled(std::string_view name);

/// No lidar was found. `others`: the ports that were not looked at; `has_looked`: whether others were. *Allocates.*
[[nodiscard]] error no_lidar(std::span<const port_info> others, bool has_looked);

}  // namespace g4lidar
