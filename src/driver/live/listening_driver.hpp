// SPDX-License-Identifier: MIT
// The driver of a one-way lidar, which sends from power-on and answers nothing.
#pragma once

#include <cstdint>

#include "live_source.hpp"

namespace g4lidar {

/// *Single thread.* Nothing is ever sent. Of the stages of live_stage.hpp it has closed, lost,
/// identifying, which ends with three valid packets, idle, scanning, breaking and broken. While it is
/// idle, what arrives is not read.
class listening_driver final : public live_source {
 public:
  using live_source::live_source;

  [[nodiscard]] result<void> start() override;
  /// Scans end. Nothing stops the motor: the event still_turning reports it.
  [[nodiscard]] result<void> stop() override;
  /// What the lidar has reported unasked; every other request is refused.
  [[nodiscard]] result<answer> ask(const request& wanted, while_scanning if_scanning) override;

 private:
  [[nodiscard]] result<void> connected() override;
  [[nodiscard]] result<void> round(std::int64_t deadline_ns) override;
  [[nodiscard]] std::int64_t due_ns() const noexcept override;
  [[nodiscard]] bool has_work() const noexcept override {
    return stage_ == live_stage::identifying;
  }
  void leave() noexcept override {}
  [[nodiscard]] result<void> look();
  [[nodiscard]] result<void> try_pulse(bool is_silent);
  [[nodiscard]] result<void> recognised();
  [[nodiscard]] result<void> drop_old();

  enum class pulse : std::uint8_t { none, low, done };

  pulse pulse_ = pulse::none;  // of the line DTR, if the lidar is silent
  std::int64_t due_ns_ = 0;    // when packets must have come
  std::uint64_t packets_ = 0;  // of the stream, when due_ns_ was set
  std::uint64_t bytes_before_ =
      0;  // that were parsed before this connection, and with the last packet
};

}  // namespace g4lidar
