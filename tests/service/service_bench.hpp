// SPDX-License-Identifier: MIT
// A service of simulated lidars and recordings, and what came to its sinks.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "g4lidar/lidar_service.hpp"
#include "g4lidar/sim/pty_port.hpp"
#include "g4lidar/sim/world.hpp"
#include "recording/recorded_run.hpp"
#include "support/patience.hpp"

namespace g4lidar::test {

inline constexpr std::int64_t second = 1'000'000'000;
inline constexpr std::int64_t recorded_ahead_ns = 1'700'000'000 * second;

/// A service_scan that owns what it views.
struct seen_scan {
  explicit seen_scan(const service_scan& from)
      : about(from),
        for_grid(from.for_grid.begin(), from.for_grid.end()),
        kept(from.kept.begin(), from.kept.end()),
        kept_of_each(from.kept_of_each.begin(), from.kept_of_each.end()) {}

  service_scan about;  // without its views
  std::vector<point> for_grid;
  std::vector<point> kept;
  std::vector<std::size_t> kept_of_each;
};

/// Remembers what came, and waits for it.
class sink_record : public service_sink {
 public:
  [[nodiscard]] service_demand wanted() const override { return {for_grid_, kept_, runs_}; }
  void on_scan(const service_scan& made) override {
    change([&] { scans.emplace_back(made); });
    if (during_scan) during_scan();
  }
  void on_odometry(const stamped_odometry& now, std::int64_t stamp_ns) override {
    change([&] { poses.emplace_back(now, stamp_ns); });
  }
  void on_time(std::size_t /*lidar*/, std::int64_t stamp_ns) override {
    change([&] { times.push_back(stamp_ns); });
  }
  void on_motion(bool is_known, const std::string& why) override {
    change([&] {
      motions.emplace_back(is_known, why);
      scans_at_motion = scans.size();
    });
  }
  void on_event(std::size_t /*lidar*/, const lidar_event& what, std::int64_t stamp_ns) override {
    change([&] { events.emplace_back(what.what, stamp_ns); });
  }
  void on_state(std::size_t lidar, reader_state state, const std::optional<error>&) override {
    change([&] { states.emplace_back(lidar, state); });
  }
  void on_values(std::size_t /*lidar*/, const std::string& refused) override {
    change([&] { values.push_back(refused); });
  }

  void want(service_demand now) {
    for_grid_ = now.for_grid;
    kept_ = now.kept;
    runs_ = now.runs;
  }
  bool wait(const std::function<bool()>& is_so) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, patience, is_so);
  }
  /// So many further scans.
  bool wait_for_scans(std::size_t count) {
    const std::size_t before = number_of_scans();
    return wait([&] { return scans.size() >= before + count; });
  }
  /// The last state is this one.
  bool wait_for_state(reader_state wanted_state, std::size_t lidar = 0) {
    const std::pair state(lidar, wanted_state);
    return wait([&] { return !states.empty() && states.back() == state; });
  }
  std::size_t number_of_scans() {
    const std::lock_guard lock(mutex);
    return scans.size();
  }

  std::function<void()> during_scan;
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<seen_scan> scans;
  std::vector<std::pair<stamped_odometry, std::int64_t>> poses;
  std::vector<std::int64_t> times;
  std::vector<std::pair<bool, std::string>> motions;
  std::size_t scans_at_motion = 0;
  std::vector<std::pair<lidar_event::kind, std::int64_t>> events;
  std::vector<std::pair<std::size_t, reader_state>> states;
  std::vector<std::string> values;

 private:
  std::atomic<bool> for_grid_ = false;
  std::atomic<bool> kept_ = true;
  std::atomic<bool> runs_ = false;

  template <class Change>
  void change(Change what) {
    const std::lock_guard lock(mutex);
    what();
    changed.notify_all();
  }
};

class Service : public ::testing::Test {
 protected:
  lidar_service& make(std::vector<service_lidar> lidars, service_options options = {}) {
    auto made = lidar_service::make(std::move(lidars), std::move(options), outputs);
    EXPECT_TRUE(made) << made.error().message();
    service = *std::move(made);
    return *service;
  }
  lidar_service& begin(std::vector<service_lidar> lidars, service_options options = {}) {
    EXPECT_TRUE(make(std::move(lidars), std::move(options)).start());
    return *service;
  }
  /// Of the only lidar.
  lidar_service& begin(const std::string& device, service_options options = {},
                       const std::optional<mounting>& mount = {}) {
    return begin({lidar_at(device, "", mount)}, std::move(options));
  }
  static service_lidar lidar_at(const std::string& device, const std::string& name = "",
                                const std::optional<mounting>& mount = {}) {
    service_lidar made{.name = name, .mount = mount};
    made.options.device = device;
    return made;
  }
  /// Reads all of a recording, as fast as it can be read.
  void play(const std::string& file, service_options options = {},
            const std::optional<mounting>& mount = {}) {
    begin(file, std::move(options), mount);
    EXPECT_TRUE(heard.wait_for_state(reader_state::ended));
    service->stop();
  }
  /// Revolutions of a recording of the built-in world.
  const std::string& recording() {
    auto writer = recording_writer::create(file_.text());
    EXPECT_TRUE(writer);
    writer->set_wall_clock(recorded_ahead_ns);
    record_device(*writer, 5 * second);
    return file_.text();
  }
  /// A simulated G4 at `port()`.
  sim::background_pty plug_in(const std::vector<std::string_view>& faults = {}) {
    return *sim::background_pty::open(sim::device(sim::built_in_world(), {}, faults_of(faults)),
                                      port());
  }
  [[nodiscard]] const std::string& port() const { return port_.text(); }
  /// The frequency of a simulated lidar in Hz.
  static double frequency_of(sim::background_pty& at) {
    double hz = 0;
    at.with([&](sim::device& device, std::int64_t) {
      hz = device.settings().scan_frequency_chz / 100.0;
    });
    return hz;
  }
  static bool is_scanning(sim::background_pty& at) {
    bool is = false;
    at.with([&](sim::device& device, std::int64_t now_ns) {
      static_cast<void>(device.available(now_ns));
      is = device.is_scanning();
    });
    return is;
  }
  /// A text file, for a setup of `sim:`.
  std::string text_file(const std::string& name, const std::string& text) {
    std::string path = directory_.text() + name;
    std::ofstream(path) << text;
    written_.push_back(path);
    return path;
  }
  [[nodiscard]] parameter_value value(const char* name) const {
    return service->value(0, *find_parameter(name));
  }
  ~Service() override {
    service.reset();
    for (const std::string& each : written_) std::remove(each.c_str());
  }

  sink_record heard;
  std::vector<service_output> outputs{{&heard, delivery::in_reader}};
  std::unique_ptr<lidar_service> service;

 private:
  temporary_path file_;
  temporary_path port_{"port"};
  temporary_path directory_{"-"};
  std::vector<std::string> written_;
};

/// The walls of a room of 8 m by 6 m around the origin.
inline constexpr const char* room =
    "wall -4 -3 4 -3\nwall 4 -3 4 3\nwall 4 3 -4 3\nwall -4 3 -4 -3\n";

/// How far places in this room are from its walls, ascending. `at`: the frame of the points.
inline std::vector<double> distances_to_walls(std::span<const point> points, const pose_2d& at) {
  std::vector<double> all;
  for (const point& each : points) {
    if (each.is_no_return()) continue;
    const xy_point own = to_xy(each, frame::robot);
    const pose_2d there =
        at * pose_2d{static_cast<double>(own.x_m), static_cast<double>(own.y_m), 0};
    all.push_back(std::min(std::abs(std::abs(there.x_m) - 4), std::abs(std::abs(there.y_m) - 3)));
  }
  std::ranges::sort(all);
  return all;
}
/// Below this distance are 99 of 100.
inline double most_of(const std::vector<double>& ascending) {
  return ascending.empty() ? 1e9 : ascending[ascending.size() * 99 / 100];
}

}  // namespace g4lidar::test
