// SPDX-License-Identifier: MIT
// One lidar, recording or simulated lidar that is served: its recording, its bytes and its rates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "byte_tap.hpp"
#include "cli/named_sources.hpp"
#include "cli/serve_verb.hpp"
#include "g4lidar/lidar_service.hpp"
#include "g4lidar/transport/source.hpp"
#include "lidar_rates.hpp"
#include "page_recorder.hpp"

namespace g4_tool {

class served_lidar {
 public:
  /// One of `count`.
  served_lidar(const serve_options& options, const named_source& source, std::size_t count);
  served_lidar(const served_lidar&) = delete;
  served_lidar& operator=(const served_lidar&) = delete;

  /// The lidar for the service. This outlives it.
  [[nodiscard]] service_lidar for_service();

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] const common_options& options() const noexcept { return options_; }
  /// Whether it is a lidar or a simulated one.
  [[nodiscard]] bool is_live() const { return !names_file(options_.source); }

  // In the thread of the reader.
  [[nodiscard]] page_recorder& recorder() noexcept { return recorder_; }
  void add(const g4lidar::scan& found);
  /// The bytes since the last call as a message; empty if nobody wanted them.
  [[nodiscard]] std::vector<std::uint8_t> take_bytes(bool is_wanted);
  /// The time of the last of these bytes, by the clock of the points.
  [[nodiscard]] std::int64_t bytes_ns() const noexcept { return bytes_.arrival_ns(); }

  /// The state now. Call it twice a second, in one thread.
  [[nodiscard]] page_status status(const lidar_service& service, std::size_t index);

 private:
  const std::string name_;
  common_options options_;
  const playback_options playback_;
  page_recorder recorder_;
  byte_tap bytes_;  // of the thread of the reader
  scan_rates rates_;
  loss_window loss_;  // of status()
};

}  // namespace g4_tool
