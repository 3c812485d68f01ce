// SPDX-License-Identifier: MIT
// A source that is read in a thread of its own, for programs that publish what comes: it is opened,
// opened again after a loss, rested, asked, and, if it is a recording, played as a player does.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/common_options.hpp"
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "g4lidar/lidar.hpp"
#include "source.hpp"

namespace g4_tool {

enum class station_state : unsigned char {
  opening,  ///< Not open yet, or no longer: it is tried again.
  running,  ///< Scans come, or will come when the head turns.
  resting,  ///< Open, and the motor stands.
  lost,     ///< Unplugged: the driver looks for it.
  ended,    ///< The end of a recording, or nothing more will come: see station::failure().
};
/// "opening", "running". Valid forever.
[[nodiscard]] std::string_view name_of(station_state state) noexcept;

/// What a program does with what comes. All calls are made in the station's thread, one at a time;
/// what they throw ends the station.
class station_listener {
 public:
  station_listener() = default;
  station_listener(const station_listener&) = delete;
  station_listener& operator=(const station_listener&) = delete;
  virtual ~station_listener() = default;

  /// It is open, before the scan is started: the lidar can be asked. Called each time it is opened,
  /// also after a seek.
  virtual void on_open(opened_source& /*source*/) {}
  virtual void on_scan(const g4lidar::scan& /*scan*/) {}
  /// Only with station_options::wants_points.
  virtual void on_points(std::span<const point> /*points*/) {}
  virtual void on_event(const lidar_event& /*event*/) {}
  /// `why`: sentences; empty where nothing went wrong.
  virtual void on_state(station_state /*state*/, std::string_view /*why*/) {}
};

class station_reader;

struct station_options {
  bool wants_points = false;   ///< Points are given as they come, with little latency.
  bool starts_rested = false;  ///< As after rest(true).
  bool loops = false;          ///< A recording begins again at its end.
  double speed = 1.0;          ///< Of a recording, as set_speed().
};

/// Where the player of a recording is.
struct playback {
  double length_s = 0;    ///< From the first to the last recorded byte.
  double position_s = 0;  ///< Since the first byte.
  double speed = 1.0;
  bool is_paused = false;
};

/// A source and its thread. *Any thread* may call every function but those that name a thread; none waits
/// for the device but stop() and the destructor, which wait at most as long as lidar::open() and
/// lidar::stop(). A recording, and raw bytes in a file, are played by their times.
///
/// on_loss: `exit` ends at the first failure or loss; `reconnect` ends if it cannot be opened at
/// first; `wait` never ends for the sake of a device, and tries again at least every two seconds. The
/// reason of each new failure is given to on_state(), and as a verbose message.
class station {
 public:
  /// `listener` must outlive this. `how.wrap` is called at each attempt, in the thread.
  station(const common_options& options, const lidar_options& how, station_listener& listener,
          const station_options& wishes = {});
  station(const station&) = delete;
  station& operator=(const station&) = delete;
  ~station();

  /// Starts the thread, once. Before it nothing is opened, and no call of the listener comes.
  void start();
  /// Stops the motor and ends the thread. Only one thread may call start() and stop().
  void stop();

  /// Whether the motor is to stand. A recording, too, is not read while it rests.
  void rest(bool rests);
  /// `what` is called in the station's thread, soon, between two scans: with the lidar, or with null
  /// while there is none (opening, lost, ended). It is not called if the station is stopped before.
  void ask(std::function<void(g4lidar::lidar*)> what);

  /// For a recording; all else ignores it. While it is paused, a seek shows one revolution.
  void pause(bool pauses);
  /// 0: without waiting; else 0.01 to 100 times as fast as recorded. Others count as the next of these.
  void set_speed(double speed);
  /// Since the first byte; less than 0 and more than the length count as these.
  void seek(double position_s);
  /// Nothing where the source is no recording, or is not open yet.
  [[nodiscard]] std::optional<playback> player() const;

  [[nodiscard]] station_state state() const;
  /// The sentences of the last on_state().
  [[nodiscard]] std::string why() const;
  /// Why it has ended for good: a failure or a bad_value. Null before, and at the end of a recording.
  [[nodiscard]] std::exception_ptr failure() const;
  /// Those of the lidar since it was opened; a seek opens a recording again.
  [[nodiscard]] lidar_counts counts() const;
  /// Nothing before it was opened, and for raw bytes.
  [[nodiscard]] std::optional<device_information> identity() const;
  /// lidar::name(); empty before it was opened.
  [[nodiscard]] std::string name() const;
  /// What running_diagnosis finds; `skipped` before it was opened.
  [[nodiscard]] std::vector<stage_report> stages() const;

  /// A point::time_ns by the wall clock, nanoseconds since 1970; of a recording, by the wall clock when it
  /// was made. Only in the station's thread.
  [[nodiscard]] std::int64_t wall_ns(std::int64_t time_ns) const noexcept;

 private:
  std::unique_ptr<station_reader> reader_;
};

}  // namespace g4_tool
