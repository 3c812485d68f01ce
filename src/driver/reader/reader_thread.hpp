// SPDX-License-Identifier: MIT
// The thread of a background_reader: opens the lidar, reads it, rests it, and opens it again.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "driver/driver.hpp"
#include "g4lidar/background_reader.hpp"
#include "g4lidar/core/wall_clock.hpp"
#include "reader_output.hpp"
#include "reader_requests.hpp"

namespace g4lidar {

/// *Any thread*, except for what belongs to the thread: wall_ns() and the private part.
class G4LIDAR_HIDDEN background_reader::thread
    : public std::enable_shared_from_this<background_reader::thread> {
 public:
  thread(const lidar_options& options, const reader_options& reading, reader_listener* listener);
  /// Of an open lidar, which is never opened again.
  thread(lidar&& given, const reader_options& options);

  thread(const thread&) = delete;
  thread& operator=(const thread&) = delete;
  ~thread();

  [[nodiscard]] result<void> start();
  void stop() noexcept;
  /// Whether this is called in the thread itself, which cannot wait for itself.
  [[nodiscard]] bool is_own() const noexcept;
  /// Of the lidar that was given.
  [[nodiscard]] const lidar_ring& points() const noexcept {
    return is_given_ ? device_->points() : empty_ring();
  }
  [[nodiscard]] std::int64_t wall_ns(std::int64_t time_ns) noexcept;

  reader_requests requests;
  reader_view view;
  std::unique_ptr<reader_queue> queue;                     // where there is no listener
  std::atomic<error_detail> detail = error_detail::usual;  // why no scan has come, while it runs

 private:
  using clock = std::chrono::steady_clock;
  /// How a file is played.
  struct playback {
    double speed = 0;
    bool is_paused = false;
    bool shows_one = false;  // scan, although it is paused
  };

  void run() noexcept;
  /// Does what was requested. False if the thread is to end.
  bool serve();
  void open();
  void close();
  void start_scan();
  void read();
  void rest();
  void seek(std::int64_t position_ns);
  /// Waits without a scan, and lets the driver do what is due.
  void look();
  /// Gives what comes within this time, or returns why nothing came.
  std::optional<error> take(lidar::milliseconds longest);
  void give_events(bool is_over);
  /// Opens it again later, or ends.
  void fail(const error& why);
  void end(const error& why);
  void set_state(reader_state state, const std::optional<error>& why = {});
  void follow_playback();
  void show_device();
  /// The device, too, as far as it has become known.
  void publish();
  /// By lidar_options::is_cancelled, and not by a stop.
  [[nodiscard]] bool is_cancelled() const {
    // A stop in between ends in false: it cancels, too.
    return options_.is_cancelled && options_.is_cancelled() && !requests.has_to_stop();
  }
  [[nodiscard]] player* played() noexcept { return device_ ? device_->player() : nullptr; }
  [[nodiscard]] reader_state state() const noexcept { return view.own().state; }

  lidar_options options_;
  reader_options how_;
  reader_listener* listener_;
  std::unique_ptr<lidar> device_;
  bool is_given_ = false;
  bool is_started_ = false;
  bool rests_ = false;
  playback playback_;
  clock::time_point retry_at_{};
  std::optional<clock::time_point> failing_since_;  // until points come, or the motor rests
  wall_clock wall_;
  clock::time_point wall_due_{};
  reader_listener nobody_;  // instead of the listener, after a stop() in the thread
  std::mutex start_mutex_;  // for start() and stop() by several threads at once
  std::thread thread_;
};

}  // namespace g4lidar
