// SPDX-License-Identifier: MIT
// The scan of a lidar in use: whether it runs, and its statistics over a sliding window.
#pragma once

#include <cstdint>
#include <optional>

#include "diagnostics/link_monitor.hpp"
#include "diagnostics/reply_statistics.hpp"
#include "diagnostics/stream_statistics.hpp"
#include "g4lidar/core/command.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/diagnostics/running_diagnosis.hpp"
#include "link/sample_size_watch.hpp"

namespace g4lidar {

/// *Single thread.* Two stretches, each as long as half a window: the current one and the one before. All
/// times are those of the transport; those of a file are those of its bytes.
class running_scan {
 public:
  enum class phase : std::uint8_t {
    rests,      ///< No scan is wanted.
    starts,     ///< The start command was sent.
    speeds_up,  ///< Packets arrive, and the head has not reached its speed.
    runs,       ///< Packets are evaluated.
  };

  explicit running_scan(const running_diagnosis_options& options)
      : half_window_ns_(options.window.count() / 2) {
    known_.frequency = options.frequency;
    if (options.sample_rate) known_.sample_rate_hz = to_hz(*options.sample_rate);
  }

  /// From the next connection on, the bytes are those of a lidar like `model`. Valid forever.
  void read_as(const model& model);

  /// A connection begins, to a device or to a file.
  void begin(bool is_device);
  /// The connection has ended.
  void end();
  /// A command was sent, after so much silence.
  void sent(bytes data, std::int64_t now_ns, std::int64_t silence_ns);
  void received(const timed_read& arrived, bytes data);

  [[nodiscard]] const model& which() const noexcept { return *which_; }
  [[nodiscard]] phase now() const noexcept { return phase_; }
  [[nodiscard]] device_snapshot& known() noexcept { return known_; }
  [[nodiscard]] const device_snapshot& known() const noexcept { return known_; }
  /// The statistics of the window.
  [[nodiscard]] stream_statistics window() const;
  /// Its length so far.
  [[nodiscard]] double seconds() const noexcept {
    return static_cast<double>(detail::saturating_sub(time_ns_, begin_.window_ns)) / 1e9;
  }
  /// Whether the device has booted during a scan since the last call.
  [[nodiscard]] bool take_reboot() noexcept { return std::exchange(happened_.reboot, false); }
  /// How long a scan was silent when it was started again, since the last call; 0: there was none.
  [[nodiscard]] std::int64_t take_stall_ns() noexcept {
    return std::exchange(happened_.stall_ns, 0);
  }
  /// Whether many bytes have arrived that belong to nothing, also while no scan is wanted.
  [[nodiscard]] bool has_garbage() const noexcept {
    return garbage_ > garbage_bytes(*which_) && !(sizes_ && sizes_->is_other());
  }

 private:
  /// Between two checks of the speed of the head.
  static constexpr std::uint64_t steady_samples = 1'000;
  /// The time by which the head has its speed.
  static constexpr std::int64_t spin_up_ns = 6'000 * ms;
  /// A file that is silent for this time was paused: a driver would have ended a scan that is silent so long.
  static constexpr std::int64_t pause_of_file_ns = 1'000 * ms;

  /// Since they were asked for.
  struct incidents {
    bool reboot = false;
    std::int64_t stall_ns = 0;
  };
  /// When they began.
  struct begins {
    std::int64_t phase_ns = 0;   // with its first packet
    std::int64_t window_ns = 0;  // the stretch before
    std::int64_t stretch_ns = 0;
  };

  void take(const observed_event& found);
  void take(const response_view& response);
  void enter(phase next);
  void look();
  /// The driver reads the bytes as its samples show, whatever model was stated.
  void follow_samples(bytes data);
  /// Whether packets arrive, so that a start command is a keep-alive.
  [[nodiscard]] bool is_current(std::int64_t now_ns) const noexcept;

  const model* which_ = &g4_model;
  std::int64_t half_window_ns_;
  phase phase_ = phase::rests;
  bool is_device_ = true;
  std::optional<command> asked_{};  // the last command
  event_splitter splitter_;
  observer to_{.event = [this](const observed_event& found) { take(found); }};
  stream_statistics measured_{g4_model, true};
  stream_tally earlier_;                    // of the stretch before
  std::optional<sample_size_watch> sizes_;  // from a start until they are as expected
  device_snapshot known_;
  std::uint64_t boots_ = 0;       // boot texts that were handled
  bool may_have_booted_ = false;  // since the last packet, or it is one of damaged bytes
  std::int64_t silence_ns_ = 0;   // since the last packet
  std::int64_t time_ns_ = 0;      // of the newest bytes
  std::int64_t packet_ns_ = 0;    // of the newest packet
  begins begin_;
  std::uint64_t garbage_ = 0;  // bytes since the last packet or response
  std::uint64_t looked_ = 0;   // samples at the last check of the speed
  incidents happened_;
};

}  // namespace g4lidar
