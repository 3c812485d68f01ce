// SPDX-License-Identifier: MIT
// A recording through the driver to a writer, as fast as it goes.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "g4lidar/lidar.hpp"
#include "g4lidar/recording_reader.hpp"
#include "output.hpp"
#include "point_writer.hpp"

namespace g4_dump {

struct played_result {
  g4lidar::lidar_counts counts;
  g4lidar::recording_damage damage;
};

/// Plays what lies in `range` until its end, a signal, `is_done`, or nobody reads `out` any more. The points and
/// their times are those of the driver that was recorded. Throws a failure.
played_result play_points(const std::string& path, const g4lidar::reading_options& range,
                          point_writer& writer, output& out, const std::function<bool()>& is_done);

/// How far the wall clock was ahead of the times in a recording, at its beginning.
[[nodiscard]] std::int64_t recorded_wall_ahead_ns(const std::string& path);

/// What is missing of a recording, a line; empty where nothing is.
[[nodiscard]] std::string words_about(const g4lidar::recording_damage& damage);

}  // namespace g4_dump
