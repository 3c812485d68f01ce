// SPDX-License-Identifier: MIT
// Sends revolutions as messages to the clients that want them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli/serve_verb.hpp"
#include "client_registry.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/scan.hpp"

namespace g4_tool {

/// When a revolution was measured.
struct scan_stamp {
  std::int64_t stamp_ns = 0;  ///< Of its first point, since 1970.
  std::int64_t duration_ns = 0;
};

/// *Single thread*, or several ones one after another.
class scan_sender {
 public:
  /// `to` outlives it.
  scan_sender(const serve_options& options, client_registry& to);

  [[nodiscard]] client_registry::demand wanted() const { return registry_.wanted(); }
  void send_page(const page_scan& what);
  /// A LaserScan of scan_shaper::for_grid().
  void send_ranges(const g4lidar::scan& for_grid, const scan_stamp& when);
  /// A PointCloud2 of scan_shaper::kept(). `time_ns` is the time of `when` by the clock of its points.
  void send_points(const g4lidar::scan& kept, const scan_stamp& when, std::int64_t time_ns);
  /// What a device sent, as a message of recordings.
  void send_bytes(std::int64_t stamp_ns, std::vector<std::uint8_t> message);

 private:
  client_registry& registry_;
  const std::string frame_id_;
  const std::optional<std::uint32_t> bins_;
  grid_options grid_;
  std::vector<float> ranges_m_;
  std::vector<float> intensities_;
};

}  // namespace g4_tool
