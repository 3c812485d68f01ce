// SPDX-License-Identifier: MIT
// What the thread of a background_reader gives to other threads.
#pragma once

#include <mutex>
#include <optional>
#include <tuple>
#include <vector>

#include "driver/event_queue.hpp"
#include "g4lidar/background_reader.hpp"
#include "scan_queue.hpp"

namespace g4lidar {

/// Keeps scans and events until they are taken.
class reader_queue final : public reader_listener {
 public:
  reader_queue(std::size_t depth, const model& model) : scans(depth, model) {}

  void on_scan(const scan& found) override { scans.put(found); }
  void on_event(const lidar_event& what) override {
    const std::lock_guard lock(mutex_);
    events_.put(what);
  }
  void on_state(reader_state state, const std::optional<error>& /*why*/) override {
    state == reader_state::ended ? scans.end() : scans.go_on();
  }
  /// *Any thread.*
  [[nodiscard]] std::optional<lidar_event> next_event() {
    const std::lock_guard lock(mutex_);
    return events_.take();
  }

  scan_queue scans;

 private:
  std::mutex mutex_;
  event_queue events_;
};

/// The state of a reader, which its thread alone changes.
class reader_view {
 public:
  template <class Change>
  void change(Change what) {
    const std::lock_guard lock(mutex_);
    what(status_, counts_);
  }
  /// Only in the thread, as the next one.
  [[nodiscard]] const reader_status& own() const noexcept { return status_; }
  /// As which model the lidar is read. Allocates where that has changed.
  void show(const recognition& now) {
    const auto facts_follow_from = [](const recognition& from) {
      return std::tuple(from.model, from.by, from.number, from.baud, from.is_silent,
                        from.speaks_telnet, from.has_shown_samples);
    };
    if (facts_follow_from(now) == facts_follow_from(shown_)) return;
    shown_ = now;
    shown_.candidates = {};
    std::vector<model_fact> facts = facts_of(now);
    const std::lock_guard lock(mutex_);
    status_.recognised.swap(facts);
  }

  // ---- any thread ----
  [[nodiscard]] reader_status status() const {
    const std::lock_guard lock(mutex_);
    return status_;
  }
  [[nodiscard]] reader_state state() const {
    const std::lock_guard lock(mutex_);
    return status_.state;
  }
  [[nodiscard]] lidar_counts counts() const {
    const std::lock_guard lock(mutex_);
    return counts_;
  }
  [[nodiscard]] std::optional<error> failed() const {
    const std::lock_guard lock(mutex_);
    return status_.state == reader_state::ended ? status_.why : std::nullopt;
  }

 private:
  mutable std::mutex mutex_;
  reader_status status_;
  lidar_counts counts_;
  recognition shown_{};  // of the thread, without its candidates
};

}  // namespace g4lidar
