// SPDX-License-Identifier: MIT
// The options of the verb sim, which writes a stream or serves devices.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "g4lidar/sim/odometry.hpp"
#include "g4lidar/sim/setup.hpp"
#include "io/source_word.hpp"

namespace g4_tool {

struct sim_options {
  double seconds = 10.0;
  sim::setup setup;
  std::string truth;
  std::string odometry_file;
  sim::odometry_options odometry;     ///< Its seed is not used: it is that of the lidar.
  bool has_odometry_options = false;  ///< Whether an option of the odometry was given.
  std::string output = "-";
  // The places of devices; without any the stream is written.
  std::vector<std::string> links{};
  std::vector<std::pair<std::string, std::uint16_t>> bridges{};
  bool is_registered = false;
  std::vector<std::string> serials{};  ///< Of the first devices.
  bool has_device_options = false;     ///< Whether an option for devices only was given.
  bool log = false;                    ///< Writes their commands to standard error.

  [[nodiscard]] std::size_t devices() const noexcept {
    return links.size() + bridges.size() + (is_registered ? 1U : 0U);
  }
};

/// Writes the bytes of a scan, the true values and the odometry.
[[nodiscard]] int write_stream(const sim_options& options);

}  // namespace g4_tool
