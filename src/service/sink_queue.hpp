// SPDX-License-Identifier: MIT
// Calls a sink in a thread of its own, with copies of what it gets.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "g4lidar/lidar_service.hpp"

namespace g4lidar {

/// Never waits for the sink. When it is full the oldest scan, else the oldest call, is left out; but never the newest
/// state and time of a lidar.
class sink_queue final : public service_sink {
 public:
  /// `target` outlives it.
  explicit sink_queue(service_sink& target) : target_(target) {}
  ~sink_queue() override { stop(); }

  /// Fails with system.
  [[nodiscard]] result<void> start();
  /// Ends after the call that is in progress.
  void stop() noexcept;

  [[nodiscard]] service_demand wanted() const override { return target_.wanted(); }
  void on_scan(const service_scan& made) override;
  void on_odometry(const stamped_odometry& now, std::int64_t stamp_ns) override;
  void on_time(std::size_t lidar, std::int64_t stamp_ns) override;
  void on_motion(bool is_known, const std::string& why) override;
  void on_event(std::size_t lidar, const lidar_event& event, std::int64_t stamp_ns) override;
  void on_state(std::size_t lidar, reader_state state, const std::optional<error>& why) override;
  void on_values(std::size_t lidar, const std::string& refused) override;

 private:
  enum class kind : std::uint8_t { scan, state, time, other };
  struct call {
    kind what;
    std::size_t lidar;
    std::function<void(service_sink&)> make;
  };
  void add(call made);
  void drop_one(kind what);
  void run();

  service_sink& target_;
  std::mutex mutex_;  // protects the next three
  std::condition_variable changed_;
  std::deque<call> calls_;
  bool is_over_ = false;
  std::thread thread_;
};

}  // namespace g4lidar
