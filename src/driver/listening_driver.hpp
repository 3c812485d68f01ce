// SPDX-License-Identifier: MIT
// The driver of a one-way lidar, which sends from power-on and answers nothing.
#pragma once

#include <cstdint>

#include "live_stage.hpp"
#include "live_stream.hpp"
#include "reconnection.hpp"
#include "scan_source.hpp"

namespace g4lidar {

/// *Single thread.* Nothing is ever sent. Of the stages of live_stage.hpp it has closed, lost,
/// identifying, which ends with three valid packets, idle, scanning, breaking and broken. While it is
/// idle, what arrives is not read.
class listening_driver final : public scan_source {
 public:
  listening_driver(parts& of, const lidar_options& options);

  [[nodiscard]] result<void> open() override;
  [[nodiscard]] result<void> start() override;
  /// Scans end. Nothing stops the motor: the event still_turning reports it.
  [[nodiscard]] result<void> stop() override;
  /// What the lidar has reported unasked; every other request is refused.
  [[nodiscard]] result<answer> ask(const request& wanted, while_scanning how) override;
  void release() noexcept override;

  [[nodiscard]] result<void> can_read() const noexcept override;
  [[nodiscard]] scan_expectation expects() const noexcept override;
  [[nodiscard]] bool has_motor_on() const noexcept override { return is_scanning(); }
  [[nodiscard]] bool is_scanning() const noexcept override {
    return stage_ == live_stage::scanning;
  }
  [[nodiscard]] std::int64_t next_deadline_ns() const noexcept override;
  [[nodiscard]] std::int64_t rest_until_ns() const noexcept override {
    return stage_ == live_stage::idle ? never_ns : stream_.rest_until_ns();
  }
  void add_to(lidar_counts& counts) const noexcept override {
    counts.reconnects = reconnection_.count();
  }

 private:
  [[nodiscard]] result<void> advance(std::int64_t deadline_ns) override;
  [[nodiscard]] result<void> round(std::int64_t deadline_ns);
  [[nodiscard]] result<void> look();
  [[nodiscard]] result<void> try_pulse(bool is_silent);
  [[nodiscard]] result<void> recognised();
  [[nodiscard]] result<void> identified();
  [[nodiscard]] result<void> be_ready();
  [[nodiscard]] result<void> drop_old();

  [[nodiscard]] result<void> connect();
  [[nodiscard]] result<void> break_off(const error& broken);
  [[nodiscard]] result<void> hang_up();

  enum class pulse : std::uint8_t { none, low, done };

  lidar_options options_;
  live_stage stage_ = live_stage::closed;
  live_stream stream_;
  reconnection reconnection_;
  pulse pulse_ = pulse::none;       // of the line DTR, if the lidar is silent
  bool wants_scan_ = false;         // the caller does, also while the lidar is lost
  bool is_recognised_ = false;      // it was, at least once
  std::int64_t due_ns_ = 0;         // when packets must have come
  std::uint64_t packets_ = 0;       // of the stream, when due_ns_ was set
  std::uint64_t bytes_before_ = 0;  // that were parsed before this connection
};

}  // namespace g4lidar
