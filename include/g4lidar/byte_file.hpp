// SPDX-License-Identifier: MIT
// A file of bytes as they came from a port, as a transport.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "g4lidar/error.hpp"
#include "g4lidar/export.hpp"
#include "g4lidar/transport.hpp"

namespace g4lidar {

/// How a file is read.
struct byte_file_options {
  /// How fast its bytes come, from the first read() on; 0: as fast as they are asked for. A G4's line
  /// brings at most 23040.
  std::uint32_t bytes_per_second = 0;
};

/// Opens files. The transport that comes of it ends with end_of_input; what is written to it is
/// swallowed, so nothing answers. Its baud() is ten times its bytes a second.
///
/// *Allocates on open*; afterwards it does not.
class G4LIDAR_API byte_file {
 public:
  byte_file() = delete;

  /// Opens the regular file at `path`. Fails with bad_option where it is something else, or with
  /// system.
  [[nodiscard]] static result<std::unique_ptr<transport>> open(
      std::string_view path, const byte_file_options& options = {});
};

}  // namespace g4lidar
