// SPDX-License-Identifier: MIT
// A recording as a device: played through the same code to the same points.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "g4lidar/connector.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/export.hpp"
#include "g4lidar/recording_reader.hpp"

namespace g4lidar {

/// How a recording is played.
struct replay_options {
  /// 1: as fast as it was recorded; 0.5: half as fast; 0: as fast as it is asked for. 0 to 1000.
  double rate = 0;
  /// Whether it begins again at its end; the times go on.
  bool loop = false;
  reading_options range{};  ///< Of the recording, in each round.
};

/// Opens recordings as lines, for lidar::open(). What comes of it does not answer, gives each reading
/// as it was read, and ends with end_of_input. Its clock is the line's that was recorded.
///
///     auto line = g4lidar::replay::open("walk.mcap", {.rate = 1});
///     auto lidar = g4lidar::lidar::open(std::move(*line));
class G4LIDAR_API replay {
 public:
  replay() = delete;

  /// Fails with bad_option, or as recording_reader::open() does.
  [[nodiscard]] static result<std::unique_ptr<connector>> open(std::string_view path,
                                                               const replay_options& options = {});

  /// What the recording that `line` plays is read with, to ask it how far it is and what is wrong with
  /// the file; null where `line` is something else. Good as long as `line`, or the lidar that has it.
  [[nodiscard]] static const recording_reader* reader_of(const connector& line) noexcept;
};

}  // namespace g4lidar
