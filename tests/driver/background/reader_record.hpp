// SPDX-License-Identifier: MIT
// What a listener of a background_reader got, for tests that wait for it.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "g4lidar/background_reader.hpp"
#include "support/patience.hpp"

namespace g4lidar::test {

/// Remembers what came, and waits for it.
class reader_record : public reader_listener {
 public:
  void on_open(lidar& /*device*/) override {
    change([&] { ++opened; });
  }
  void on_scan(const scan& found) override {
    change([&] {
      scans.push_back(found.revolution);
      points += found.size();
      last_size = found.size();
      last_time_ns = found.time_ns();
      last_scan_wall_ns = of == nullptr ? 0 : of->wall_ns(found.time_ns());
    });
  }
  void on_points(std::span<const point> some) override {
    change([&] { live_points += some.size(); });
  }
  void on_event(const lidar_event& what) override {
    change([&] { events.emplace_back(name_of(what.what)); });
  }
  void on_state(reader_state state, const std::optional<error>& why) override {
    change([&] {
      states.emplace_back(name_of(state));
      if (why) whys.push_back(*why);
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
  background_reader* of = nullptr;
  int opened = 0;
  std::vector<std::uint32_t> scans;
  std::size_t points = 0;
  std::size_t last_size = 0;
  std::size_t live_points = 0;
  std::int64_t last_time_ns = 0;
  std::int64_t last_scan_wall_ns = 0;
  std::vector<std::string> events;
  std::vector<std::string> states;
  std::ptrdiff_t states_seen = 0;
  std::vector<error> whys;

 private:
  template <class Change>
  void change(Change what) {
    const std::lock_guard lock(mutex);
    what();
    changed.notify_all();
  }
};

}  // namespace g4lidar::test
