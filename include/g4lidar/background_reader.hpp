// SPDX-License-Identifier: MIT
// An optional thread that reads a lidar, so that the application need not call the lidar in time.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/options/option_table.hpp"

namespace g4lidar {

/// What a background_reader does.
enum class reader_state : std::uint8_t {
  opening,  ///< Not open yet, or no longer: it tries again.
  running,  ///< Scans come, or will come when the motor has spun up.
  resting,  ///< Open, and the motor stands.
  lost,     ///< Unplugged: the driver looks for it.
  ended,    ///< No more scans follow, unless a file is continued by a seek.
};
/// The name in tools and documents: "opening", "running". Valid forever.
[[nodiscard]] G4LIDAR_API std::string_view name_of(reader_state state) noexcept;

/// Where the player of a file is.
struct playback_status {
  std::int64_t length_ns = 0;    ///< See player::length_ns().
  std::int64_t position_ns = 0;  ///< See player::position_ns().
  double speed = 0;              ///< See playback_options::speed.
  bool is_paused = false;        ///< By background_reader::pause().
};

/// A background_reader as it is now.
struct reader_status {
  reader_state state = reader_state::opening;
  /// Why it is lost, could not be opened, or has ended.
  std::optional<error> why{};
  /// Nothing until the lidar has identified itself: raw bytes may never do so.
  std::optional<device_information> information{};
  /// As which model it is read: facts_of() the recognition() of the lidar; empty before it was opened.
  std::vector<model_fact> recognised{};
  std::string name{};                         ///< lidar::name(); empty before it was opened.
  std::optional<playback_status> playback{};  ///< Of a file that is played.
};

/// What a background_reader does, besides lidar_options.
struct reader_options {
  bool newest_only = false;  ///< next_scan() gives the newest scan only; older ones are dropped.
  bool wants_points =
      false;  ///< Points are given to the listener as they come, with little latency.
  bool starts_rested = false;  ///< As after rest(true).
};

/// What a program does with what comes. All calls are made in the thread of the reader, one at a time. They
/// throw nothing. They may call every function of the reader: see there.
class G4LIDAR_API reader_listener {
 public:
  reader_listener() = default;
  reader_listener(const reader_listener&) = delete;
  reader_listener& operator=(const reader_listener&) = delete;
  virtual ~reader_listener();

  /// It is open, before the scan is started: the lidar can be asked. Called each time it is opened.
  virtual void on_open(lidar& /*device*/) {}
  /// Each scan, with its flags; valid during the call.
  virtual void on_scan(const scan& /*found*/) {}
  /// With reader_options::wants_points: all points, each once; valid during the call.
  virtual void on_points(std::span<const point> /*found*/) {}
  /// Each event of the lidar, but not that a file is at its end.
  virtual void on_event(const lidar_event& /*what*/) {}
  /// The state, or the reason for it, has changed. `why`: reader_status::why.
  virtual void on_state(reader_state /*state*/, const std::optional<error>& /*why*/) {}
};

/// Reads a lidar in a thread of its own and provides its scans and points: to one thread that calls
/// next_scan(), or to a listener. *Any thread* may call any function except construction, assignment, destruction and
/// those that name a thread; only one thread at a time may call next_scan(). *Allocates on open.* A moved-from reader
/// behaves like a stopped one.
///
/// The same functions may be called in the thread of the reader: by a listener, by a function that was given to ask(),
/// and by the functions of lidar_options. There no function waits for the thread: stop() lets it end after the call,
/// and next_scan() gives what has come already. After a stop() there the listener is not called again. Destruction and
/// assignment there are like stop(): the thread ends later, by itself, and then stops the motor.
///
///     auto reader = background_reader::start(std::move(*lidar));
///     while (running) {
///       auto scan = reader->next_scan(500ms);
///       if (scan) use(*scan);
///       else if (scan.error().is_fatal()) return report(scan.error());
///     }
///
/// One that opens the lidar itself can open it again. It ends at an error that does not pass (error::may_pass()),
/// and at all others when lidar_options::device_wait has passed without a success: points, or a motor at rest. It
/// tries again twice a second. lidar_options::reconnect is that of the lidar.
class G4LIDAR_API background_reader {
 public:
  /// Starts the scan, then the thread. Blocks at most as long as lidar::start(); if it fails, the
  /// lidar is closed, which may also take as long as lidar::close(). Errors: those of
  /// lidar::start(), and system.
  [[nodiscard]] static result<background_reader> start(lidar&& device,
                                                       const reader_options& options = {});

  /// Opens nothing before start(). With a listener, which outlives this, next_scan() and next_event() give
  /// nothing. `options.wrap` and `options.is_cancelled` are called in the thread.
  explicit background_reader(const lidar_options& options, const reader_options& reading = {},
                             reader_listener* listener = nullptr);
  /// Starts the thread of a reader that opens the lidar itself. A further call does nothing. Fails with system, and
  /// with gone after stop(): make another reader then.
  [[nodiscard]] result<void> start();

  background_reader(background_reader&&) noexcept;
  background_reader& operator=(background_reader&&) noexcept;
  /// Like stop().
  ~background_reader();

  /// Wakes and ends the thread, and stops the motor. Blocks at most as long as lidar::stop(), and as a call of
  /// lidar::open(), lidar::start() or the listener that is in progress. In the thread itself it does not block. A
  /// second call does nothing; after one in the thread itself it waits until the thread has ended.
  void stop() noexcept;

  /// The oldest scan that was not taken yet, with its flags; valid until the next call of
  /// next_scan(). The last four scans are kept; older ones are dropped and counted as
  /// `scans_missed`. Errors: timeout, with the details of lidar::try_scan(); if the reader has ended, the
  /// error of failed(); after stop(), not_scanning.
  [[nodiscard]] view_result<scan> next_scan(lidar::milliseconds timeout);

  /// Every point. Valid as long as this reader, also after a move and after stop(). Empty if the reader opens
  /// the lidar itself: see reader_listener::on_points().
  [[nodiscard]] const lidar_ring& points() const noexcept;

  /// Why the reader has ended by itself: `end_of_input` at the end of a file; nothing otherwise.
  [[nodiscard]] std::optional<error> failed() const;
  /// Those of the lidar since it was opened; at most 0.1 s old while points arrive.
  [[nodiscard]] lidar_counts counts() const;
  /// The oldest event that was not taken yet; nothing if there is none.
  [[nodiscard]] std::optional<lidar_event> next_event();
  /// The state, and what belongs to it. Allocates.
  [[nodiscard]] reader_status status() const;

  /// Whether the motor is to stand. A file, too, is not read while it rests.
  void rest(bool rests);
  /// `what` is called in the thread, soon, between two scans: with the lidar, or with null while there is none
  /// (opening, lost, ended). It is not called if the reader is stopped before. In the thread of the reader, too, it is
  /// called later.
  void ask(std::function<void(lidar*)> what);

  /// Pauses the player of a file; a seek then gives one scan. Everything else ignores it.
  void pause(bool pauses);
  /// The same for the speed. Fails with bad_option: see playback_options::speed.
  [[nodiscard]] result<void> set_speed(double speed);
  /// Continues there, at most at one second before the end, in a file that is open. Also after its end.
  void seek(std::int64_t position_ns);

  /// A point::time_ns by the wall clock, in nanoseconds since 1970; of a file, by the wall clock when it was
  /// made. Only in the thread of the reader.
  [[nodiscard]] std::int64_t wall_ns(std::int64_t time_ns) const noexcept;

 private:
  class thread;
  explicit background_reader(std::shared_ptr<thread> made) noexcept;
  std::shared_ptr<thread> thread_;  // its own thread holds it, too
};

}  // namespace g4lidar
