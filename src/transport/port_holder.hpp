// SPDX-License-Identifier: MIT
// Which process has a port open, as far as this user may know. Reads /proc; allocates.
#pragma once

#include <sys/stat.h>

#include <map>
#include <string>

#include "g4lidar/error.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar {

/// Whether this is the end of pseudo-terminals at which simulators are, or the device that makes them: /dev/ptmx.
/// Each process that opens it gets one of its own. *Pure.*
[[nodiscard]] bool is_pty_master(const struct stat& file) noexcept;

/// The process that holds the lock on this file, "screen (1234)"; empty if the system does not show
/// it.
[[nodiscard]] std::string lock_holder(const struct stat& file);

/// By path: which process has a file below /dev open. Only root sees the processes of other users.
[[nodiscard]] std::map<std::string, std::string> device_holders();

/// The process that holds the port at `path`, by its lock or by having it open; empty if none is
/// visible.
[[nodiscard]] std::string port_holder(const std::string& path);

/// Which other process has the port at `path` open, "cat (1234)"; empty if none is visible. The
/// simulator of a device, at the other end of a pseudo-terminal, is not counted.
[[nodiscard]] std::string port_conflict(const std::string& path);

/// `why`; or interference instead, if another process has the port open or has changed its
/// settings, and `why` can be a result of that. Examines all processes; allocates.
[[nodiscard]] error with_port_conflict(const error& why, const transport& port) noexcept;

}  // namespace g4lidar
