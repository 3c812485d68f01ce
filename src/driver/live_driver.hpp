// SPDX-License-Identifier: MIT
// The driver of a live device: connects, sets up, reads, and reconnects after a loss.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "feeder.hpp"
#include "open_question.hpp"
#include "reconnection.hpp"
#include "setup_sequence.hpp"

namespace g4lidar {

/// The state machine of a live device. *Single thread.*
///
///     stage        action                                next stage
///     -----------  ------------------------------------  --------------------------------------------
///     closed       none                                  -
///     lost         connects again, with growing pauses   identifying
///     identifying  queries the identity                  idle; preparing, if it was scanning before;
///                                                        lost, if it is another device
///     idle         the requests of the caller            preparing, by start(); stopping, by stop()
///     preparing    health, settings, start               scanning; idle, if the device refuses
///     scanning     reads                                 stopping, by stop(); preparing, if the device
///                                                        seems to have rebooted
///     stopping     stop; it may be woken                 idle, by stop(); preparing, by start()
///     breaking     decodes the received bytes            broken
///     broken       waits until the last scan is taken    lost; closed, if reconnecting is off
///
/// A connection that breaks in the stage identifying leads to lost or closed, in a later stage to breaking.
class live_driver final : public feeder {
 public:
  live_driver(parts& of, const lidar_options& options);

  [[nodiscard]] result<void> open() override;
  [[nodiscard]] result<void> start() override;
  [[nodiscard]] result<void> stop() override;
  [[nodiscard]] result<answer> ask(const request& wanted, while_scanning how) override;
  void release() noexcept override;

  [[nodiscard]] result<void> can_read() const noexcept override;
  [[nodiscard]] scan_expectation expects() const noexcept override;
  [[nodiscard]] bool has_motor_on() const noexcept override {
    return stage_ >= stage::preparing && stage_ <= stage::stopping;
  }
  [[nodiscard]] bool is_scanning() const noexcept override {
    return stage_ == stage::scanning && wants_scan_;  // otherwise a stop was woken
  }
  [[nodiscard]] std::int64_t next_deadline_ns() const noexcept override;
  [[nodiscard]] std::int64_t rest_until_ns() const noexcept override;
  [[nodiscard]] std::int64_t deadline_after_ns(std::int64_t timeout_ns) const noexcept override;
  void add_to(lidar_counts& counts) const noexcept override;

 private:
  enum class stage : std::uint8_t {
    closed,
    lost,
    identifying,
    idle,
    preparing,
    scanning,
    stopping,
    breaking,
    broken
  };

  [[nodiscard]] result<void> advance(std::int64_t deadline_ns) override;

  // The connection.
  [[nodiscard]] result<void> connect();
  [[nodiscard]] result<void> wait_for_return(std::int64_t deadline_ns);
  [[nodiscard]] result<void> break_off(const error& broken);
  [[nodiscard]] result<void> hang_up();
  void leave_stopped(const error& why) noexcept;
  void flush();
  [[nodiscard]] error unavailable() const;

  // One round.
  [[nodiscard]] result<void> round(std::int64_t deadline_ns);
  [[nodiscard]] result<bool> serve();
  [[nodiscard]] result<void> send_commands();
  [[nodiscard]] result<void> look_if_due();
  [[nodiscard]] result<void> take_notice();
  [[nodiscard]] result<void> receive(std::int64_t deadline_ns);
  [[nodiscard]] bool parse_bytes();
  void follow_delivery();
  void begin_points();
  void cut();
  void record(recorded_event::kind what);
  [[nodiscard]] reading how_to_read() const noexcept;
  [[nodiscard]] bool is_cut_off() const noexcept;
  [[nodiscard]] bool is_known() const noexcept { return information_.model == model_g4; }
  [[nodiscard]] bool is_waiting_for_answer() const noexcept {
    return session_.is_busy() || !session_.is_scanning();
  }

  // The setup sequence.
  void add_step(setup_step step);
  void add_start();
  [[nodiscard]] bool set_up_again();
  [[nodiscard]] result<void> run_setup();
  [[nodiscard]] result<bool> go_on_with_setup();
  [[nodiscard]] result<void> finish_step(const outcome& done);
  [[nodiscard]] result<void> identified(const device_information& who);
  [[nodiscard]] result<void> give_up(const error& why);
  [[nodiscard]] result<void> begin_question(const request& wanted, while_scanning how);
  void learn_rate(const outcome& done);
  void remember(const outcome& done);
  void restore_settings(const outcome& done);
  void started();
  void back_again();
  [[nodiscard]] task task_of(const request& asked) const noexcept;
  [[nodiscard]] error error_of(const outcome& done) const;
  [[nodiscard]] error silence_error() const;
  [[nodiscard]] error error_after(const error& why) const;

  lidar_options options_;
  session session_;
  setup_sequence setup_;
  open_question question_;
  reconnection reconnection_;
  stage stage_ = stage::closed;
  bool wants_scan_ = false;                   // the caller does, also while the lidar is lost
  error lost_{task::reading, problem::gone};  // why it is lost or closed
  std::optional<error> refused_;  // why a setup ended, although the connection works; see advance()
};

}  // namespace g4lidar
