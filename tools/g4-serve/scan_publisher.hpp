// SPDX-License-Identifier: MIT
// Converts the products of a lidar_service to messages for the client registry, and requests of clients to its changes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/named_sources.hpp"
#include "cli/serve_verb.hpp"
#include "client_registry.hpp"
#include "g4lidar/lidar_service.hpp"
#include "served_lidar.hpp"

namespace g4_tool {

class scan_publisher final : private service_sink {
 public:
  /// `lidars`: one, or several ones that are merged. `other`: one more sink, called after this one. Throws a failure if
  /// the mask cannot be read, and bad_value for too many lidars. `clients` outlives this.
  scan_publisher(const serve_options& options, const std::vector<named_source>& lidars,
                 client_registry& clients, service_sink* other = nullptr);

  /// Opens the lidars, once. Throws a failure.
  void start();
  /// Stops the motors.
  void stop() noexcept { service_->stop(); }
  /// The failure of the first lidar if all have one: what works is shown.
  [[nodiscard]] std::optional<failure> failure_of_all() const;
  /// Publishes status and diagnostics. Call it twice a second, in one thread. Returns the status.
  page_status tick();

  // lidar_actions. *Any thread.*
  void set(const set_request& wanted, std::function<void(const std::string&)> done);
  void play(const play_request& wanted);
  void record(const record_request& wanted, std::function<void(const std::string&)> done);

 private:
  [[nodiscard]] service_demand wanted() const override;
  void on_open(std::size_t lidar, g4lidar::lidar& device) override;
  void on_measured(std::size_t lidar, const scan& found) override;
  void on_scan(const service_scan& made) override;
  void on_odometry(const stamped_odometry& now, std::int64_t stamp_ns) override;
  void on_motion(bool is_known, const std::string& why) override;
  void on_event(std::size_t lidar, const lidar_event& what, std::int64_t stamp_ns) override;
  void on_state(std::size_t lidar, reader_state state, const std::optional<error>& why) override;
  void on_values(std::size_t lidar, const std::string& refused) override;

  [[nodiscard]] std::vector<page_lidar> known() const;
  void send_hello(bool sends);
  void record_one(std::size_t lidar, bool is_on, std::function<void(const std::string&)> done);
  void publish_diagnostics();

  const serve_options options_;
  const std::string frame_id_;
  client_registry& registry_;
  std::deque<served_lidar> lidars_;
  std::vector<const g4lidar::model*> models_;  // as pages know them
  std::vector<float> ranges_m_;
  std::vector<float> intensities_;
  unsigned ticks_ = 0;
  std::unique_ptr<lidar_service> service_;  // its threads end first
};

}  // namespace g4_tool
