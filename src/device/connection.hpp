// SPDX-License-Identifier: MIT
// tcp_port::open(), with the system calls of a test.
#pragma once

#include <memory>
#include <string_view>

#include "g4lidar/tcp_port.hpp"
#include "system_calls.hpp"

namespace g4lidar {

[[nodiscard]] result<std::unique_ptr<transport>> open_connection(std::string_view address,
                                                                 const tcp_options& options,
                                                                 const system_calls& calls);

}  // namespace g4lidar
