// SPDX-License-Identifier: MIT
// byte_file::open(), with the system calls of a test.
#pragma once

#include <memory>
#include <string_view>

#include "g4lidar/byte_file.hpp"
#include "system_calls.hpp"

namespace g4lidar {

[[nodiscard]] result<std::unique_ptr<transport>> open_file_line(std::string_view path,
                                                                const byte_file_options& options,
                                                                const system_calls& calls);

}  // namespace g4lidar
