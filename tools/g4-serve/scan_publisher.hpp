// SPDX-License-Identifier: MIT
// Converts what comes from the lidars to messages for the client registry, and requests of clients to commands.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cli/named_sources.hpp"
#include "cli/serve_verb.hpp"
#include "client_registry.hpp"
#include "scan_maker.hpp"
#include "scan_sender.hpp"
#include "served_lidar.hpp"

namespace g4_tool {

class scan_publisher final : private lidar_listener {
 public:
  /// `lidars`: one, or with `options.merges` those that are merged. Throws a failure if the mask cannot be read, and
  /// bad_value for too many lidars. `to` outlives this.
  scan_publisher(const serve_options& options, const std::vector<named_source>& lidars,
                 client_registry& to);

  /// Those of the constructor, in order: attach a reader to each.
  [[nodiscard]] const std::vector<std::unique_ptr<served_lidar>>& lidars() const noexcept {
    return lidars_;
  }

  /// Publishes status and diagnostics. Call it twice a second, in one thread. Returns the status.
  page_status tick();

  // lidar_actions. *Any thread.*
  void set(const set_request& wanted, std::function<void(const std::string&)> done);
  void play(const play_request& wanted);
  void record(const record_request& wanted, std::function<void(const std::string&)> done);

 private:
  void on_lidar_open(served_lidar& from, g4lidar::lidar& device) override;
  void on_lidar_scan(served_lidar& from, const g4lidar::scan& scan) override;
  void on_lidar_change(bool sends) override;
  void on_lidar_settings() override;

  [[nodiscard]] std::vector<page_lidar> known() const;
  void publish_diagnostics(const page_status& status);

  const serve_options options_;
  client_registry& registry_;
  scan_sender sender_;
  std::unique_ptr<scan_maker> maker_;
  std::vector<std::unique_ptr<served_lidar>> lidars_;
  std::vector<std::function<g4lidar::diagnostic_status()>> reports_;  // of tick(), as the next one
  unsigned ticks_ = 0;
};

}  // namespace g4_tool
