// SPDX-License-Identifier: MIT
// The sinks of a service as one, which is called by the threads of several lidars one after another.
#pragma once

#include <deque>
#include <mutex>
#include <vector>

#include "g4lidar/lidar_service.hpp"
#include "service/sink_queue.hpp"

namespace g4lidar {

class sink_group {
 public:
  explicit sink_group(const std::vector<service_output>& outputs) {
    for (const service_output& each : outputs) {
      const bool has_thread = each.how == delivery::own_thread;
      sinks_.push_back(has_thread ? &queues_.emplace_back(*each.sink) : each.sink);
    }
  }

  /// Fails with system.
  [[nodiscard]] result<void> start() {
    for (sink_queue& each : queues_) {
      if (const auto started = each.start(); !started) return started;
    }
    return {};
  }
  /// Ends the threads of sinks.
  void stop() noexcept {
    for (sink_queue& each : queues_) each.stop();
  }

  /// What at least one of them wants. *Any thread.*
  [[nodiscard]] service_demand wanted() const {
    service_demand all;
    for (const service_sink* each : sinks_) {
      const service_demand here = each->wanted();
      all.for_grid |= here.for_grid;
      all.kept |= here.kept;
      all.runs |= here.runs;
    }
    return all;
  }

  /// Calls `call` with each of them. The caller holds mutex(), except for on_open().
  template <class Call>
  void each(Call call) {
    for (service_sink* const each : sinks_) call(*each);
  }
  /// The same with a lock of its own.
  template <class Call>
  void call(Call call) {
    const std::lock_guard lock(mutex_);
    each(call);
  }
  [[nodiscard]] std::mutex& mutex() noexcept { return mutex_; }

 private:
  std::mutex mutex_;  // of calls
  std::deque<sink_queue> queues_;
  std::vector<service_sink*> sinks_;
};

}  // namespace g4lidar
