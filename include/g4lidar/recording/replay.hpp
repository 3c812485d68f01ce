// SPDX-License-Identifier: MIT
// A recording as a device: the same code decodes it to the same points.
#pragma once

#include <functional>
#include <memory>
#include <string_view>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/recording/player.hpp"
#include "g4lidar/recording/reader.hpp"
#include "g4lidar/transport/connector.hpp"

namespace g4lidar {

/// Opens recordings as connectors, for lidar::open(). The device of the resulting transport does
/// not answer; the transport returns the bytes of each read as they were recorded, and ends with
/// end_of_input. Its clock is that of the recorded transport.
///
///     auto recording = g4lidar::replay::open("walk.mcap", {.speed = 1});
///     auto lidar = g4lidar::lidar::open(std::move(*recording));
class G4LIDAR_API replay {
 public:
  replay() = delete;

  /// `is_cancelled`: see reading_options; also while it is played. Fails with bad_option, or like
  /// recording_reader::open().
  [[nodiscard]] static result<std::unique_ptr<connector>> open(
      std::string_view path, const playback_options& options = {},
      const std::function<bool()>& is_cancelled = {});

  /// The reader of the recording that `from` plays, for its position and its damage; null if `from`
  /// is something else. Valid as long as `from`, or the lidar that owns it.
  [[nodiscard]] static const recording_reader* reader_of(connector& from) noexcept;
};

}  // namespace g4lidar
