// SPDX-License-Identifier: MIT
// The driver of a live device: its stages, and the calls that move it through them.
#pragma once

#include <cstdint>
#include <optional>

#include "live_stage.hpp"
#include "live_stream.hpp"
#include "open_question.hpp"
#include "reconnection.hpp"
#include "scan_source.hpp"
#include "setup_sequence.hpp"

namespace g4lidar {

/// *Single thread.* live_stage.hpp has the table of the stages.
class live_driver final : public scan_source {
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
    return stage_ >= live_stage::preparing && stage_ <= live_stage::stopping;
  }
  [[nodiscard]] bool is_scanning() const noexcept override {
    return stage_ == live_stage::scanning && wants_scan_;  // otherwise a stop was woken
  }
  [[nodiscard]] std::int64_t next_deadline_ns() const noexcept override;
  [[nodiscard]] std::int64_t rest_until_ns() const noexcept override {
    return stream_.rest_until_ns();
  }
  void add_to(lidar_counts& counts) const noexcept override;

 private:
  [[nodiscard]] result<void> advance(std::int64_t deadline_ns) override;
  [[nodiscard]] result<void> round(std::int64_t deadline_ns);
  [[nodiscard]] result<bool> serve();

  // The connection.
  [[nodiscard]] result<void> connect();
  [[nodiscard]] result<void> break_off(const error& broken);
  [[nodiscard]] result<void> hang_up();

  // The setup sequence, and the request of the caller.
  [[nodiscard]] bool set_up_again();
  [[nodiscard]] result<void> run_setup();
  [[nodiscard]] result<bool> go_on_with_setup();
  [[nodiscard]] result<void> take_outcome(const outcome& done);
  [[nodiscard]] result<void> finish_step(const outcome& done);
  [[nodiscard]] result<void> identified(const device_information& who);
  [[nodiscard]] result<void> give_up(const error& why);

  lidar_options options_;
  live_stage stage_ = live_stage::closed;
  live_stream stream_;
  setup_sequence setup_;
  open_question question_;
  reconnection reconnection_;
  bool wants_scan_ = false;       // the caller does, also while the lidar is lost
  std::optional<error> refused_;  // why a setup ended, although the connection works; see advance()
};

}  // namespace g4lidar
