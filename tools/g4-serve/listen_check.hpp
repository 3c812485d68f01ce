// SPDX-License-Identifier: MIT
// Why a server cannot listen, before it tries to: libwebsockets does not return the reason.
#pragma once

#include <cstdint>
#include <string>

namespace g4_tool {

/// Throws a bad_value for an address that is not in numbers, and a failure where the address and the
/// port cannot be used now. `port` 0: any.
void check_listening(const std::string& address, std::uint16_t port);

}  // namespace g4_tool
