// SPDX-License-Identifier: MIT
// The command line of g4-serve, which is also that of `g4-dump serve`.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common_options.hpp"
#include "named_sources.hpp"
#include "verbs.hpp"

namespace g4_tool {

struct serve_options {
  serve_options() {
    common.on_loss.usual = loss_rule::wait;
    common.frame = frame::robot;  // as in the page
  }

  /// Of every lidar; without source and mounting.
  common_options common;
  std::vector<std::string> sources;  ///< "SOURCE", or "NAME=SOURCE".
  std::vector<named_mounting> mounts;
  bool merges = false;
  std::string address = "127.0.0.1";
  std::uint16_t port = 8765;  ///< 0: any free port.
  bool allows_set = false;
  std::string record_directory;                          ///< Empty: nobody may record.
  std::uint64_t record_limit = std::uint64_t{4} << 30U;  ///< Bytes of all recordings in it.
  std::vector<std::string> origins;                      ///< Of other web pages that may connect.
  std::optional<std::uint32_t> bins;  ///< Ranges of a LaserScan; default_bins() of the model.
  std::string frame_id;               ///< Empty: see frame_id_of().
  double speed = 1.0;                 ///< Of the playback of a recording.
  bool loops = false;
};

/// The frame of the messages: that of the lidar or, of merged scans, of the robot.
[[nodiscard]] std::string frame_id_of(const serve_options& options);

/// The verb `name`, executed by `run`.
[[nodiscard]] verb make_serve_verb(std::string name,
                                   const std::function<int(const serve_options&)>& run);

}  // namespace g4_tool
