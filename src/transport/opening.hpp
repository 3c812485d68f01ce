// SPDX-License-Identifier: MIT
// serial_port::open(), byte_file::open() and tcp_port::open() with replaceable system calls, for tests.
#pragma once

#include <memory>
#include <string_view>

#include "g4lidar/transport/byte_file.hpp"
#include "g4lidar/transport/serial_port.hpp"
#include "g4lidar/transport/tcp_port.hpp"
#include "system_calls.hpp"

namespace g4lidar {

[[nodiscard]] result<std::unique_ptr<transport>> open_serial_transport(
    std::string_view path, const serial_options& options, const system_calls& calls);
[[nodiscard]] result<std::unique_ptr<transport>> open_file_transport(
    std::string_view path, const byte_file_options& options, const system_calls& calls);
[[nodiscard]] result<std::unique_ptr<transport>> open_connection(std::string_view address,
                                                                 const tcp_options& options,
                                                                 const system_calls& calls);

}  // namespace g4lidar
