// SPDX-License-Identifier: MIT
// Turns what a station gives into messages for the client registry, and requests of clients into commands.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "byte_tap.hpp"
#include "cli/serve_verb.hpp"
#include "client_registry.hpp"
#include "g4lidar/scan_shaper.hpp"
#include "io/deskew_report.hpp"
#include "io/station.hpp"

namespace g4_tool {

/// The rates of the last scans. *Any thread.*
class scan_rates {
 public:
  using clock = std::chrono::steady_clock;

  void add(const g4lidar::scan& scan, clock::time_point now);
  /// Writes what is known of the time before `now`; nothing where no scan came lately.
  void put(page_status& into, clock::time_point now) const;

 private:
  mutable std::mutex mutex_;
  std::deque<clock::time_point> times_;
  double sample_rate_hz_ = 0;
  double frequency_hz_ = 0;
};

/// The part of the samples that was lost in the last ten seconds. *Single thread.*
class loss_window {
 public:
  /// Twice a second: all counts so far. Returns the part.
  double add(const lidar_counts& counts);

 private:
  struct sums {
    std::uint64_t points;
    std::uint64_t lost;
  };
  std::deque<sums> sums_;
};

class scan_publisher final : public station_listener {
 public:
  /// Throws a failure for a mask that cannot be read. `to` outlives this.
  scan_publisher(const serve_options& options, client_registry& to);
  /// Before it is started; `from` outlives this.
  void attach(station& from) { station_ = &from; }
  /// How the station opens the source. This outlives the station.
  [[nodiscard]] lidar_options how_to_open() {
    return {.wrap = for_each_connection(
                [this](auto inner) { return bytes_.observe(std::move(inner)); })};
  }

  // In the station's thread.
  void on_open(opened_source& source) override;
  void on_scan(const g4lidar::scan& scan) override;
  void on_event(const lidar_event& event) override;
  void on_state(station_state state, std::string_view why) override;

  /// Twice a second, in one thread: status and diagnostics.
  void tick();

  // hub_actions. *Any thread.*
  void set(const set_request& wanted, std::function<void(const std::string&)> done);
  void play(const play_request& wanted);

 private:
  void send_hello(bool sends);
  void execute(g4lidar::lidar* lidar, const std::string& word,
               const std::function<void(const std::string&)>& done);
  void publish_diagnostics(const page_status& status);
  void publish_bytes(bool is_wanted);

  const serve_options options_;
  client_registry& registry_;
  station* station_ = nullptr;
  scan_shaper shaper_;
  std::optional<deskew_report> report_;  // if it deskews
  byte_tap bytes_;                       // of the station's thread
  scan_rates rates_;
  std::vector<float> ranges_m_;
  nlohmann::ordered_json settings_;  // of the station's thread
  loss_window loss_;                 // of tick(), as the next
  unsigned ticks_ = 0;
};

}  // namespace g4_tool
