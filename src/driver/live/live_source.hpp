// SPDX-License-Identifier: MIT
// What all live devices have in common: their connection, its loss, and the attempts to reconnect.
#pragma once

#include <cstdint>
#include <optional>

#include "driver/scan_source.hpp"
#include "live_stage.hpp"
#include "live_stream.hpp"
#include "reconnection.hpp"

namespace g4lidar {

/// *Single thread.* It has the stages closed, lost, breaking and broken of live_stage.hpp, and leads
/// to identifying. What a device has to be asked between them is up to its driver.
class live_source : public scan_source {
 public:
  live_source(parts& used, const lidar_options& options);

  [[nodiscard]] result<void> open() override;
  void release(bool rests) noexcept override;

  [[nodiscard]] result<void> can_read() const noexcept override;
  [[nodiscard]] scan_expectation expects() const noexcept override;
  [[nodiscard]] bool has_motor_on() const noexcept override {
    return stage_ >= live_stage::preparing && stage_ <= live_stage::stopping;
  }
  [[nodiscard]] bool is_scanning() const noexcept override {
    return stage_ == live_stage::scanning && wants_scan_;  // otherwise a stop was woken
  }
  [[nodiscard]] std::int64_t next_deadline_ns() const noexcept override;
  [[nodiscard]] std::int64_t rest_until_ns() const noexcept override {
    return stream_.rest_until_ns();
  }
  void add_to(lidar_counts& counts) const noexcept override {
    counts.command_retries = stream_.talk().retries();
    counts.reconnects = reconnection_.count();
  }

 protected:
  /// The connection has broken, or is of no use. The bytes received so far are still processed.
  [[nodiscard]] result<void> break_off(const error& broken);
  /// Waits until the driver has nothing to do any more, or it fails. If the caller calls repeatedly
  /// while the device is away, a later call completes after the reconnect.
  [[nodiscard]] result<void> settle();
  /// The device has identified itself. An error if it is another one than before, or cannot be of the
  /// model.
  [[nodiscard]] result<void> identified(const device_information& who);

  /// Reads the bytes as those of another model if their samples have another size. Everything that was received is
  /// parsed. An error if the model was stated.
  [[nodiscard]] result<void> follow_samples();

  // ---- the driver of the device ----

  /// A connection was opened: begins to identify the device.
  [[nodiscard]] virtual result<void> connected() = 0;
  /// Does what is due, and reads at most once. Not in the stages of this class.
  [[nodiscard]] virtual result<void> round(std::int64_t deadline_ns) = 0;
  /// When the next round is due, if nothing arrives.
  [[nodiscard]] virtual std::int64_t due_ns() const noexcept = 0;
  /// Whether settle() waits, while the connection is open.
  [[nodiscard]] virtual bool has_work() const noexcept = 0;
  /// The device will not be controlled any more: what has been begun is forgotten.
  virtual void leave() noexcept = 0;

  /// The device has identified itself.
  void become_recognised() noexcept {
    recognised_.set_bridge(stream_.speaks_telnet(), std::exchange(is_recognised_, true));
  }

  lidar_options options_;
  live_stage stage_ = live_stage::closed;
  live_stream stream_;
  reconnection reconnection_;
  std::optional<error> refused_;  // why a request ended, although the connection works
  bool wants_scan_ = false;       // the caller does, also while the lidar is lost
  bool is_recognised_ = false;    // it was, at least once

 private:
  [[nodiscard]] result<void> advance(std::int64_t deadline_ns) final;
  [[nodiscard]] result<void> connect();
  [[nodiscard]] bool refuses(const device_information& who) const noexcept;
  [[nodiscard]] std::uint32_t known_baud() const noexcept;
  [[nodiscard]] result<void> hang_up();
  void judge_model() noexcept;
};

}  // namespace g4lidar
