// SPDX-License-Identifier: MIT
// A file of raw bytes from a port, as a transport.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar {

/// How a file is read.
struct byte_file_options {
  /// Bytes per second, from the first read() on; 0: as fast as read() is called. The connection of
  /// a G4 carries at most 23040.
  std::uint32_t bytes_per_second = 0;
};

/// Opens files. The resulting transport ends with end_of_input; what is written to it is discarded,
/// so there are no replies. Its baud() is ten times its bytes per second.
///
/// *Allocates on open*, not afterwards.
class G4LIDAR_API byte_file {
 public:
  byte_file() = delete;

  /// Opens the regular file at `path`. Fails with bad_option if it is something else, or with
  /// system.
  [[nodiscard]] static result<std::unique_ptr<transport>> open(
      std::string_view path, const byte_file_options& options = {});
};

}  // namespace g4lidar
