// SPDX-License-Identifier: MIT
// Which program has a port open, as far as this user may know. Reads /proc; allocates.
#pragma once

#include <sys/stat.h>

#include <map>
#include <string>

namespace g4lidar {

/// Who holds the lock on this file, "screen (1234)"; empty where the system does not tell.
[[nodiscard]] std::string lock_holder(const struct stat& file);

/// By path: who has a file below /dev open. Programs of other users are seen by root only.
[[nodiscard]] std::map<std::string, std::string> device_holders();

/// Who holds the port at `path`, by its lock or by having it open; empty where nobody is seen.
[[nodiscard]] std::string port_holder(const std::string& path);

/// Which other process has the port at `path` open, "cat (1234)"; empty where none is seen. Whoever
/// plays the device, at the other end of a pseudo-terminal, does not count.
[[nodiscard]] std::string port_rival(const std::string& path);

}  // namespace g4lidar
