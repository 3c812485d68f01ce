// SPDX-License-Identifier: MIT
// What a running diagnosis knows: the scan, the events and errors of the driver, and when each was found.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <limits>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "diagnostics/stages.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/diagnostics/running_diagnosis.hpp"
#include "g4lidar/recording/contents.hpp"
#include "g4lidar/transport/transport.hpp"
#include "running_scan.hpp"

namespace g4lidar {

/// Diagnoses with the time at which they were last found.
class found_diagnoses {
 public:
  found_diagnoses() noexcept { times_.fill(never); }
  void add(diagnosis diagnosis, std::int64_t now_ns) noexcept {
    times_[static_cast<std::size_t>(diagnosis)] = now_ns;
  }
  [[nodiscard]] bool has(diagnosis diagnosis, std::int64_t since_ns) const noexcept {
    return times_[static_cast<std::size_t>(diagnosis)] >= since_ns;
  }
  [[nodiscard]] std::vector<diagnosis> since(std::int64_t since_ns) const {
    std::vector<diagnosis> all;
    for (std::size_t i = 0; i < diagnosis_count; ++i) {
      if (times_[i] >= since_ns) all.push_back(static_cast<diagnosis>(i));
    }
    return all;
  }

 private:
  static constexpr std::int64_t never = std::numeric_limits<std::int64_t>::min();
  std::array<std::int64_t, diagnosis_count> times_{};
};

/// Used by the thread of the lidar, and by those that call stages().
class running_state {
 public:
  explicit running_state(const running_diagnosis_options& options)
      : window_ns_(std::clamp<std::int64_t>(options.window.count(), 1'000 * ms, 3'600'000 * ms)),
        scan_({std::chrono::nanoseconds(window_ns_), options.frequency, options.sample_rate}) {}

  void begin(bool is_device, const recorded_device* recorded, const model& model) {
    const std::lock_guard hold(mutex_);
    is_device_ = is_device;
    scan_.read_as(model);
    if (recorded == nullptr) return;
    scan_.known().information = recorded->information;
    if (recorded->frequency) scan_.known().frequency = recorded->frequency;
    if (recorded->sample_rate) scan_.known().sample_rate_hz = to_hz(*recorded->sample_rate);
  }
  void connected(const transport& to) {
    const std::lock_guard hold(mutex_);
    name_ = to.name();
    baud_ = is_device_ ? to.baud() : 0;
    scan_.begin(is_device_);
  }
  void disconnected() {
    const std::lock_guard hold(mutex_);
    scan_.end();
  }
  void passed(std::int64_t now_ns) {
    const std::lock_guard hold(mutex_);
    now_ns_ = now_ns;
  }
  void sent(bytes data, std::int64_t now_ns, std::int64_t silence_ns) {
    const std::lock_guard hold(mutex_);
    now_ns_ = now_ns;
    scan_.sent(data, now_ns, silence_ns);
    follow_scan();
  }
  void received(const timed_read& arrived, bytes data, std::int64_t now_ns) {
    const std::lock_guard hold(mutex_);
    now_ns_ = now_ns;
    // A port that gives bytes is there, also where no scan runs.
    if (lost_ && stage_of(*lost_) == diagnostic_stage::port) back();
    if (lost_ == diagnosis::stalls) stall_ns_ = std::max(stall_ns_, silence_ns());
    heard_ns_ = now_ns;
    scan_.received(arrived, data);
    follow_scan();
  }
  [[nodiscard]] bool is_device() const noexcept { return is_device_; }

  void add(const lidar_event& what);
  void add(const error& why);

  [[nodiscard]] std::vector<stage_report> stages(const point_filter& directions) const;

 private:
  /// What stages() needs, copied while no byte is processed.
  struct copy {
    running_scan::phase phase;
    stream_statistics measured;
    device_snapshot known;
    const model* which;
    std::vector<diagnosis> found;
    double seconds;
    std::uint32_t baud;
    stage_report port;
    std::string name;
    bool is_device;
    error_detail lost_case;
    std::int64_t stall_ns;

    void add_to(stage_report& report) const;
  };
  [[nodiscard]] copy take_copy() const;

  /// The lidar works.
  void back() {
    lost_.reset();
    why_lost_.clear();
    lost_case_ = error_detail::usual;
  }
  /// Since the last bytes.
  [[nodiscard]] std::int64_t silence_ns() const noexcept {
    return detail::saturating_sub(now_ns_, heard_ns_);
  }
  void follow_scan() {
    if (scan_.take_reboot()) found_.add(diagnosis::reboots, now_ns_);
    if (const std::int64_t stall_ns = scan_.take_stall_ns(); stall_ns > 0) {
      found_.add(diagnosis::stalls, now_ns_);
      stall_ns_ = stall_ns;
    }
    if (scan_.has_garbage()) found_.add(diagnosis::wrong_baud_rate, now_ns_);
    // Packets come again: it had ended by itself, or by a boot.
    if (scan_.now() >= running_scan::phase::speeds_up && std::exchange(is_restarted_, false) &&
        !found_.has(diagnosis::reboots, detail::saturating_sub(now_ns_, window_ns_))) {
      found_.add(diagnosis::scan_ends, now_ns_);
    }
    if (lost_ && scan_.now() == running_scan::phase::runs) back();
  }

  mutable std::mutex mutex_;
  std::int64_t window_ns_;
  running_scan scan_;
  found_diagnoses found_;
  std::optional<diagnosis> lost_{};  // why the lidar cannot be used now
  std::int64_t stall_ns_ = 0;        // the last one after which it was started again
  std::int64_t heard_ns_ = 0;        // when the last bytes came
  std::string why_lost_{};
  error_detail lost_case_ = error_detail::usual;
  bool is_restarted_ = false;  // the driver has restarted it, and no packet has come yet
  std::uint64_t reconnects_ = 0;
  std::int64_t now_ns_ = 0;
  std::string name_{};
  std::uint32_t baud_ = 0;
  bool is_device_ = true;
};

}  // namespace g4lidar
