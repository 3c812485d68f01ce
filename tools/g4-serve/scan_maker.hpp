// SPDX-License-Identifier: MIT
// Makes what clients get of the scans of lidars: filtered, deskewed and, of several lidars, merged.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "cli/named_sources.hpp"
#include "cli/serve_verb.hpp"
#include "g4lidar/diagnostics/diagnostic_message.hpp"
#include "g4lidar/scan_shaper.hpp"
#include "io/deskew_report.hpp"
#include "io/moving_scans.hpp"
#include "scan_sender.hpp"
#include "served_lidar.hpp"

namespace g4_tool {

/// In the threads of the lidars.
class scan_maker {
 public:
  scan_maker() = default;
  scan_maker(const scan_maker&) = delete;
  scan_maker& operator=(const scan_maker&) = delete;
  virtual ~scan_maker() = default;

  virtual void open(served_lidar& from, g4lidar::lidar& device) = 0;
  /// Sends what is wanted of a scan, and records the odometry that comes with it.
  virtual void add(served_lidar& from, const g4lidar::scan& found) = 0;
  /// Its parts of the diagnostics. Call them in one thread.
  [[nodiscard]] virtual std::vector<std::function<g4lidar::diagnostic_status()>> reports() = 0;
};

/// Of the only lidar, in its frame.
class single_scans final : public scan_maker {
 public:
  /// Throws a failure if the mask cannot be read.
  single_scans(const serve_options& options, scan_sender& to);

  void open(served_lidar& from, g4lidar::lidar& device) override;
  void add(served_lidar& from, const g4lidar::scan& found) override;
  [[nodiscard]] std::vector<std::function<g4lidar::diagnostic_status()>> reports() override;

 private:
  scan_sender& sender_;
  moving_scans scans_;
  scan_shaper unmoved_;                  // for messages, if only the page's points are deskewed
  std::optional<deskew_report> report_;  // if it deskews
};

/// Of several lidars, in the frame of the robot. Throws a failure if the mask cannot be read, and bad_value for too many
/// lidars.
[[nodiscard]] std::unique_ptr<scan_maker> make_merged_scans(const serve_options& options,
                                                            const std::vector<named_source>& lidars,
                                                            scan_sender& to);

}  // namespace g4_tool
