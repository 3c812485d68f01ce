// SPDX-License-Identifier: MIT
// The thread of a station: opens the source, reads it, and opens it again.
#pragma once

#include <chrono>
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "g4lidar/diagnostics/running_diagnosis.hpp"
#include "g4lidar/owned_scan.hpp"
#include "g4lidar/wall_clock.hpp"
#include "playback_clock.hpp"
#include "source.hpp"
#include "station.hpp"
#include "station_board.hpp"

namespace g4_tool {

/// All but the public part belongs to the thread; of `diagnosis`, all but stages().
class station_reader {
 public:
  station_reader(const common_options& options, const lidar_options& how,
                 station_listener& listener, const station_options& wishes);
  station_reader(const station_reader&) = delete;
  station_reader& operator=(const station_reader&) = delete;
  ~station_reader() { stop(); }

  void start();
  void stop();
  [[nodiscard]] std::int64_t wall_ns(std::int64_t time_ns) const noexcept;

  station_board board;
  running_diagnosis diagnosis;

 private:
  using clock = std::chrono::steady_clock;
  /// Where a recording begins, how long it is, and how far its wall clock was ahead of its times.
  struct recorded_times {
    std::int64_t first_ns = 0;
    double length_s = 0;
    std::int64_t wall_ahead_ns = 0;
  };
  struct source_nature {
    bool is_file = false;       // a recording or raw bytes
    bool has_patience = false;  // what cannot be opened is tried again
  };
  /// What has happened since the last opening.
  struct progress {
    bool is_paced = false;    // it is a file: its times are waited for
    bool is_started = false;  // a scan
    bool is_over = false;     // it was a file
    bool is_left = false;     // it is to be opened again
  };

  [[nodiscard]] recorded_times times_of(const std::string& path) const;

  void run() noexcept;
  void end(const std::exception_ptr& failure, const std::string& why) noexcept;
  void set_state(station_state state, const std::string& why = {});
  /// From an opening to the next.
  void live();
  void open();
  void close();
  /// Does what was requested. False if the source is to be closed.
  bool serve();
  /// Takes what has come, or waits for it. False if the source is to be opened again.
  bool step();
  /// False while the lidar is lost.
  bool start_scan();
  bool rest();
  /// Waits, and lets the driver do what it does without a scan.
  void look();
  /// Whether there was something.
  bool take(g4lidar::lidar& lidar, g4lidar::lidar::milliseconds longest);
  void check(const error& why);
  void give(const g4lidar::scan& scan);
  void give(std::span<const point> points);
  /// Waits until recorded data is due. False if the source is to be closed.
  bool hold(std::int64_t begin_ns, std::int64_t end_ns);
  /// At the end of a file. Returns false: it is opened again where it loops, and after a seek.
  bool wait_at_end();
  void report_events();
  [[nodiscard]] bool is_lost() const { return board.state() == station_state::lost; }
  void publish();
  void show_player(std::optional<double> position_s);

  common_options options_;
  lidar_options how_;
  station_listener& listener_;
  station_options wishes_;
  source_nature nature_;
  bool rests_ = false;
  bool shows_one_ = false;  // although it is paused
  double begin_s_ = 0;      // of the next opening of a recording
  progress at_;
  std::unique_ptr<opened_source> source_;
  std::optional<recorded_times> recorded_;
  playback_clock playback_;
  wall_clock wall_;
  clock::time_point wall_due_{};
  std::chrono::nanoseconds backoff_;
  owned_scan held_;
  std::thread thread_;
};

}  // namespace g4_tool
