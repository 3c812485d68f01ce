// SPDX-License-Identifier: MIT
// The messages of one lidar on /diagnostics.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "dds/bus.hpp"
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "ros2_options.hpp"
#include "scan_messages.hpp"

namespace g4_tool {

/// The delivery of the scans to subscribers. *Pure* except for its own state.
class topic_report {
 public:
  /// A warning if more was lost or refused than at the last call.
  [[nodiscard]] diagnostic_status status(const named_counts& topics);

 private:
  struct totals {
    std::uint64_t lost = 0;
    std::uint64_t refused = 0;
  };
  totals before_;
};

/// *Single thread*, that of the bus.
class lidar_diagnostics {
 public:
  /// `name`: of the lidar; empty for the only one.
  lidar_diagnostics(dds::bus& bus, const ros2_options& options, std::string_view name_space,
                    std::string_view name);

  /// Publishes once a second, if there are subscribers: what `diagnose` gives, whose names begin with "g4lidar: ", which
  /// is replaced by the name of the node. `stamp_ns`: the time since 1970; 0: unknown, nothing is published.
  void update(const std::function<std::vector<diagnostic_status>()>& diagnose,
              const scan_messages& messages, std::int64_t stamp_ns);

 private:
  using clock = std::chrono::steady_clock;

  std::string prefix_;                     // of the names of statuses: the node and the lidar
  std::unique_ptr<dds::publisher> topic_;  // null: off
  topic_report topics_;
  clock::time_point due_{};
};

}  // namespace g4_tool
