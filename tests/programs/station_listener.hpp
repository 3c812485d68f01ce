// SPDX-License-Identifier: MIT
// What a station reported, for tests that wait for it.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/station.hpp"
#include "support/patience.hpp"

namespace g4lidar::test {

/// Remembers what came, and waits for it.
class station_record : public g4_tool::station_listener {
 public:
  void on_open(g4_tool::opened_source& /*source*/) override {
    change([&] {
      ++opened;
      scans_since_opening = 0;
    });
  }
  void on_scan(const g4lidar::scan& scan) override {
    change([&] {
      scans.push_back(scan.revolution);
      ++scans_since_opening;
      points += scan.size();
      last_size = scan.size();
      last_scan_wall_ns = of == nullptr ? 0 : of->wall_ns(scan.time_ns());
    });
  }
  void on_points(std::span<const g4lidar::point> some) override {
    change([&] { live_points += some.size(); });
  }
  void on_event(const g4lidar::lidar_event& event) override {
    change([&] { events.emplace_back(name_of(event.what)); });
  }
  void on_state(g4_tool::station_state state, std::string_view why) override {
    change([&] {
      states.emplace_back(name_of(state));
      whys.emplace_back(why);
    });
  }

  bool wait(const std::function<bool()>& is_so) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, patience, is_so);
  }
  /// Further scans, after all that came before.
  bool wait_for_scans(std::size_t count) {
    const std::size_t before = number_of_scans();
    return wait([&] { return scans.size() >= before + count; });
  }
  /// A further state, after that of the last call: another may have followed it.
  bool wait_for_state(const std::string& name) {
    return wait([&] {
      const auto found = std::find(states.begin() + states_seen, states.end(), name);
      if (found == states.end()) return false;
      states_seen = found - states.begin() + 1;
      return true;
    });
  }
  std::size_t number_of_scans() {
    const std::lock_guard lock(mutex);
    return scans.size();
  }

  std::mutex mutex;
  std::condition_variable changed;
  g4_tool::station* of = nullptr;
  int opened = 0;
  std::vector<std::uint32_t> scans;
  std::size_t scans_since_opening = 0;
  std::size_t points = 0;
  std::size_t last_size = 0;
  std::size_t live_points = 0;
  std::int64_t last_scan_wall_ns = 0;
  std::vector<std::string> events;
  std::vector<std::string> states;
  std::ptrdiff_t states_seen = 0;
  std::vector<std::string> whys;

 private:
  template <class Change>
  void change(Change what) {
    const std::lock_guard lock(mutex);
    what();
    changed.notify_all();
  }
};

}  // namespace g4lidar::test
