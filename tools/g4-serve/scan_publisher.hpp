// SPDX-License-Identifier: MIT
// Converts scans, events and states to messages for the client registry, and requests of clients to commands.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "byte_tap.hpp"
#include "cli/serve_verb.hpp"
#include "client_registry.hpp"
#include "g4lidar/scan_shaper.hpp"
#include "io/deskew_report.hpp"
#include "io/moving_scans.hpp"
#include "io/source_reader.hpp"
#include "page_recorder.hpp"

namespace g4_tool {

/// The rates of the recent scans. *Any thread.*
class scan_rates {
 public:
  using clock = std::chrono::steady_clock;

  void add(const g4lidar::scan& scan, clock::time_point now);
  /// Sets the rates at `now`; sets nothing if no scan was received recently.
  void put(page_status& into, clock::time_point now) const;

 private:
  mutable std::mutex mutex_;
  std::deque<clock::time_point> times_;
  double sample_rate_hz_ = 0;
  double frequency_hz_ = 0;
};

/// The ratio of lost samples in the last ten seconds. *Single thread.*
class loss_window {
 public:
  /// Call it twice a second with the counts. Returns the ratio.
  double add(const lidar_counts& counts);

 private:
  struct sums {
    std::uint64_t points;
    std::uint64_t lost;
  };
  std::deque<sums> sums_;
};

class scan_publisher final : public reader_listener {
 public:
  /// Throws a failure if the mask cannot be read. `to` outlives this.
  scan_publisher(const serve_options& options, client_registry& to);
  /// Call it before `from` is started. `from` outlives this.
  void attach(source_reader& from) { source_ = &from; }
  /// The options for opening the source. This outlives the reader.
  [[nodiscard]] lidar_options how_to_open();

  // In the thread of the reader.
  void on_open(g4lidar::lidar& device) override;
  void on_scan(const g4lidar::scan& scan) override;
  void on_event(const lidar_event& event) override;
  void on_state(reader_state state, const std::optional<error>& why) override;

  /// Publishes status and diagnostics. Call it twice a second, in one thread.
  void tick();

  // lidar_actions. *Any thread.*
  void set(const set_request& wanted, std::function<void(const std::string&)> done);
  void play(const play_request& wanted);
  void record(const record_request& wanted, std::function<void(const std::string&)> done);

 private:
  [[nodiscard]] background_reader& reader() const { return source_->reader(); }
  void send_hello(bool sends);
  void execute(g4lidar::lidar* lidar, const std::string& word,
               const std::function<void(const std::string&)>& done);
  [[nodiscard]] bool is_live() const;
  void publish_page(const g4lidar::scan& scan);
  void publish_diagnostics(const page_status& status);
  void publish_bytes(bool is_wanted);

  const serve_options options_;
  client_registry& registry_;
  source_reader* source_ = nullptr;
  moving_scans scans_;   // of the thread of the reader, as the next two
  scan_shaper unmoved_;  // for messages, if only the page's points are deskewed
  page_recorder recorder_;
  std::optional<deskew_report> report_;  // if it deskews
  byte_tap bytes_;                       // of the thread of the reader
  scan_rates rates_;
  std::vector<float> ranges_m_;
  std::vector<float> intensities_;
  nlohmann::ordered_json settings_;  // of the thread of the reader
  loss_window loss_;                 // of tick(), like the next member
  unsigned ticks_ = 0;
};

}  // namespace g4_tool
