// SPDX-License-Identifier: MIT
// What is behind the handles of a lidar and of a recording.
#pragma once

#include <g4lidar/c/lidar.h>
#include <g4lidar/c/player.h>
#include <g4lidar/c/recording.h>

#include <cstdint>
#include <memory>
#include <string>

#include "g4lidar/lidar.hpp"
#include "g4lidar/recording/reader.hpp"
#include "g4lidar/recording/writer.hpp"
#include "g4lidar/settings.hpp"
#include "simulation.hpp"

namespace g4lidar::c {

/// How a lidar is opened: options, and what it must not outlive.
struct opening {
  lidar_options how;
  std::shared_ptr<simulation> simulated;       // the device it is on
  std::shared_ptr<recording_writer> recorder;  // what records it
  std::string recording;                       // the file that it plays
};

[[nodiscard]] g4lidar_identity identity_of(const device_information& from) noexcept;
[[nodiscard]] g4lidar_recording_info info_of(const recording_reader& from) noexcept;
void fill(g4lidar_scan& out, const scan& scan) noexcept;
void fill(g4lidar_event& out, const lidar_event& event) noexcept;
void fill(g4lidar_counts& out, const lidar_counts& counts) noexcept;

}  // namespace g4lidar::c

struct g4lidar_lidar {
  g4lidar::c::opening from;  // outlives the lidar
  std::unique_ptr<g4lidar::lidar> made;
  g4lidar::connector* connector = nullptr;  // the innermost one; null: not of this lidar any more
  std::int64_t wall_ahead_ns = 0;           // of virtual time
  std::string name;
  g4lidar_identity identity{};
  std::string candidates;  // of `recognised`, as the next
  std::string contradictions;
  g4lidar_recognition recognised{};
  g4lidar_scan scan{};
  g4lidar_counts counts{};
  g4lidar_recording_info info{};
  g4lidar_playback playback{};
};

struct g4lidar_recorder {
  std::shared_ptr<g4lidar::recording_writer> made;
  g4lidar_recorder_counts counts{};
};
