// SPDX-License-Identifier: MIT
// One lidar, or several ones on a robot as one, as finished products for programs that publish, show or use them.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "g4lidar/background_reader.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/lidar_event.hpp"
#include "g4lidar/lidar_options.hpp"
#include "g4lidar/message/ros_messages.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/options/filter_text.hpp"
#include "g4lidar/options/lidar_parameters.hpp"
#include "g4lidar/scan.hpp"
#include "g4lidar/scan_shaper.hpp"

namespace g4lidar {

/// One of the lidars of a service.
struct service_lidar {
  std::string name{};  ///< "front"; empty for the only one.
  lidar_options
      options{};  ///< How it is opened; `wrap` and `is_cancelled` are called in its thread,
                  ///< `is_cancelled` also by make().
  /// Where it is on the robot. That of a single `sim:` is known; of several lidars, one without it is at the origin.
  std::optional<mounting> mount{};
  /// Of the device, made each time when it is opened, until they are changed.
  std::vector<named_value> settings{};
};

/// What a service does. By default it filters nothing and deskews nothing.
struct service_options {
  bool merges =
      false;  ///< Whether one lidar, too, is given as merged ones: in the frame of the robot.
  filter_settings filters{};  ///< At the beginning; lidar_service::change() changes them.
  g4lidar::mask mask{};       ///< Returns inside are left out.
  deskewing deskew = deskewing::none;
  /// Whether points are deskewed, and places known, where the source itself states its motion, although `deskew` is none:
  /// of a robot of `sim:`, and of a recording with odometry whose lidar has a `mount` and is the only one.
  bool follows_motion = false;
  bool restamps = false;  ///< See shaping_options::restamps.
  /// Whether points and odometry are given as they come, and not with each scan.
  bool gives_points = false;
  bool reads_settings = false;  ///< Whether the lidar is asked for all settings when it is opened.
  bool is_standby = false;      ///< Whether the motors rest from 3 s after no sink wants anything.
  /// The motion that another program states, for deskewing::by_path where the source states none: adds poses until the
  /// end of a scan, by the clock of its points. `ahead_ns`: the clock of stamps minus that one. In the thread of a lidar.
  std::function<void(odometry_path&, const scan&, std::int64_t ahead_ns)> other_odometry{};
  std::string other_odometry_place{};  ///< Where that is, for texts: "on /odom".
  /// Stamps by another clock than the wall clock: from the wall clock minus the clock of the points to the difference
  /// that is used; nothing as long as it is not known. In the threads of the lidars, of several ones at the same time.
  std::function<std::optional<std::int64_t>(std::int64_t wall_ahead_ns)> stamp_clock{};
};

/// What a sink wants.
struct service_demand {
  bool for_grid = false;  ///< service_scan::for_grid.
  bool kept = false;      ///< service_scan::kept.
  bool runs = false;      ///< All else, which is always given: motors do not rest.

  /// Whether the motors have to run.
  [[nodiscard]] bool has_any() const noexcept { return for_grid || kept || runs; }
};

/// Where a frame (of a lidar or of the robot) was at a time.
struct lidar_place {
  pose_2d pose{};         ///< In the map.
  std::uint32_t map = 0;  ///< Its number; poses of different maps have nothing in common.

  /// Whether both are the same.
  friend bool operator==(const lidar_place&, const lidar_place&) = default;
};

/// A scan as a service gives it: of one lidar in its own frame, or of all in that of the robot, with the turn of a G4.
/// Valid during a call.
struct service_scan {
  /// Which of the products were made: those that a sink wants, and `for_grid` of merged lidars. The others are empty.
  service_demand made{};
  scan for_grid{};  ///< For fill_grid() and fill_laser_scan().
  scan kept{};      ///< What the filters keep.
  std::span<const std::size_t>
      kept_of_each{};            ///< Of merged: so many points are of each lidar, in order.
  grid_options grid{};           ///< What ranges without return become, and the longest range.
  std::int64_t first_ns = 0;     ///< The time of its first point, or to which all are deskewed.
  std::int64_t duration_ns = 0;  ///< Until the first point of the next one.
  /// The clock of stamps minus that of the points; nothing as long as it is not known.
  std::optional<std::int64_t> ahead_ns{};
  std::optional<lidar_place> place{};  ///< Where its frame is; nothing if the motion is not known.
  bool is_upside_down =
      false;  ///< Whether the top of the lidar is down: y points to the other side.

  /// A point::time_ns as the stamp of a message, since 1970; 0 as long as it is not known.
  [[nodiscard]] G4LIDAR_API std::int64_t stamp_ns(std::int64_t time_ns) const noexcept;
};

/// What a program does with the products of a service. One call at a time, except on_open(); calls of one lidar are in order.
/// They throw nothing. No call may wait for another thread that calls stop() or destroys the service.
class G4LIDAR_API service_sink {
 public:
  service_sink() = default;
  service_sink(const service_sink&) = delete;
  service_sink& operator=(const service_sink&) = delete;
  virtual ~service_sink();

  /// What is wanted now. *Any thread*, often; does not block.
  [[nodiscard]] virtual service_demand wanted() const = 0;

  /// A shaped scan, also if nothing of it is wanted; of merged lidars one for each revolution of the first one that works.
  /// Of one lidar also pieces, with lidar_options::partial_scans.
  virtual void on_scan(const service_scan& /*made*/) {}
  /// A pose of the robot that the source states, in time with the points; `stamp_ns` as service_scan::stamp_ns().
  virtual void on_odometry(const stamped_odometry& /*now*/, std::int64_t /*stamp_ns*/) {}
  /// With service_options::gives_points: the time until which points have come. That of a recording is the time when it
  /// was recorded.
  virtual void on_time(std::size_t /*lidar*/, std::int64_t /*stamp_ns*/) {}
  /// Whether the motion is known by which points are deskewed, and why not: after several scans without one.
  virtual void on_motion(bool /*is_known*/, const std::string& /*why*/) {}
  /// An event of a lidar.
  virtual void on_event(std::size_t /*lidar*/, const lidar_event& /*what*/,
                        std::int64_t /*stamp_ns*/) {}
  /// The state of its reader, or the reason for it, has changed.
  virtual void on_state(std::size_t /*lidar*/, reader_state /*state*/,
                        const std::optional<error>& /*why*/) {}
  /// A setting in lidar_service::value() or the model has changed. `refused`: why settings could not be made when the
  /// lidar was opened; else empty.
  virtual void on_values(std::size_t /*lidar*/, const std::string& /*refused*/) {}

  // Only of a sink that is called in the threads of lidars: see delivery.
  /// It was opened; its scan is not started yet: it can be asked. It may run at the same time as calls of other
  /// lidars.
  virtual void on_open(std::size_t /*lidar*/, g4lidar::lidar& /*device*/) {}
  /// A scan as it was measured, before it is shaped; also a piece of one.
  virtual void on_measured(std::size_t /*lidar*/, const scan& /*found*/) {}
};

/// In which thread a sink is called.
enum class delivery : std::uint8_t {
  /// In one of its own, with copies: of scans the newest four, of states and times the newest one of each lidar, of all
  /// else the newest 64. What does not fit is left out.
  /// A slow sink delays nobody.
  own_thread,
  in_reader,  ///< In those of the lidars: it returns within 20 ms.
};

/// A sink and how it is called. It outlives the service.
struct service_output {
  service_sink* sink = nullptr;
  delivery how = delivery::own_thread;
};

/// Reads lidars in a thread each; shapes, deskews and merges their scans; judges the lidars; lets their motors rest.
/// *Any thread* may call every function but construction and destruction. Allocates.
///
///     struct user final : service_sink {
///       service_demand wanted() const override { return {.kept = true}; }
///       void on_scan(const service_scan& made) override { use(made.kept); }
///     } here;
///     auto service = lidar_service::make({{.options = {.device = "/dev/ttyUSB0"}}}, {}, {{&here}});
///     if (!service) return report(service.error());
///     if (const auto started = (*service)->start(); !started) return report(started.error());
///     std::this_thread::sleep_for(60s);
class G4LIDAR_API lidar_service {
 public:
  /// Opens nothing but a recording, for its odometry. One lidar, or 2 to 32 that are merged. Fails with bad_option,
  /// which names what is wrong: no lidar, too many, two of one name, a setting that does not exist, a file that is to be
  /// merged, an output without a sink.
  [[nodiscard]] static result<std::unique_ptr<lidar_service>> make(
      std::vector<service_lidar> lidars, service_options options,
      std::vector<service_output> outputs);
  lidar_service(const lidar_service&) = delete;
  lidar_service& operator=(const lidar_service&) = delete;
  /// Like stop().
  ~lidar_service();

  /// Starts the threads that do not run yet. Fails with system, and with gone after stop().
  [[nodiscard]] result<void> start();
  /// Ends the threads and stops the motors. No sink is called after it. Not in a sink, nor in a function that is given
  /// to change() or ask(). See background_reader::stop().
  void stop() noexcept;
  /// Whether motors may run; so they may at the beginning.
  void allow(bool runs) noexcept;

  /// How many lidars there are.
  [[nodiscard]] std::size_t size() const noexcept;
  /// Whether the source states the motion of a robot; that of a recording is only read if the options use it.
  [[nodiscard]] bool has_odometry() const noexcept;
  /// Of `lidar`, less than size(): as of background_reader.
  [[nodiscard]] reader_status status(std::size_t lidar) const;
  /// The same.
  [[nodiscard]] lidar_counts counts(std::size_t lidar) const;
  /// The same: background_reader::ask().
  void ask(std::size_t lidar, std::function<void(g4lidar::lidar*)> what);
  /// Why it is lost, could not be opened or has ended, if that is an error: not at the end of a file.
  [[nodiscard]] std::optional<error> failure_of(std::size_t lidar) const;
  /// Whether all have ended.
  [[nodiscard]] bool has_ended() const;
  /// The judgement of running_diagnosis, of the directions that the filters keep.
  [[nodiscard]] std::vector<stage_report> stages(std::size_t lidar) const;
  /// Its model as it is read; null before it is opened.
  [[nodiscard]] const g4lidar::model* model(std::size_t lidar) const;
  /// Its value of a parameter, of filters that of all; nothing if it is not known.
  [[nodiscard]] parameter_value value(std::size_t lidar, const parameter& row) const;
  /// A point::time_ns of it as a stamp since 1970; 0 as long as it is not known. Only in its thread.
  [[nodiscard]] std::int64_t stamp_ns(std::size_t lidar, std::int64_t time_ns) const;

  /// Changes values, all or none: settings of this lidar, filters of all. `done` is called once, in any thread, with the
  /// reason if they are refused, else with an empty text. It is called after `longest` at the latest; then the lidar may
  /// still be set later. Settings are refused at once while the lidar is searched, before start() and after stop();
  /// filters alone can always be changed. If a setting is refused, those before it are undone as far as the lidar
  /// answers.
  void change(std::size_t lidar, std::vector<named_value> wanted,
              std::function<void(const std::string&)> done,
              std::chrono::milliseconds longest = std::chrono::seconds(10));
  /// The same, and waits for it. Not in the thread of a lidar.
  [[nodiscard]] std::string change_now(
      std::size_t lidar, std::vector<named_value> wanted,
      std::chrono::milliseconds longest = std::chrono::seconds(10));

  /// Of files: as of background_reader.
  void pause(bool pauses);
  /// The same.
  [[nodiscard]] result<void> set_speed(double speed);
  /// The same.
  void seek(std::int64_t position_ns);

  /// Statuses for /diagnostics. First those of each lidar, with its name: state, stages, counts. Then those of merging
  /// and deskewing. `why`: reader_status::why of a lidar in the words of the program; an empty text is no error.
  /// *One thread at a time.*
  [[nodiscard]] std::vector<diagnostic_status> diagnosis(
      const std::function<std::string(std::size_t lidar)>& why = {});
  /// Those of merging and deskewing alone.
  [[nodiscard]] std::vector<diagnostic_status> motion_diagnosis();

 private:
  struct state;
  explicit lidar_service(std::unique_ptr<state> made);
  std::unique_ptr<state> state_;
};

}  // namespace g4lidar
