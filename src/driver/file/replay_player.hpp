// SPDX-License-Identifier: MIT
// Plays sources that do not answer: a recording, or a file of bytes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "driver/scan_source.hpp"
#include "link/identity_reader.hpp"
#include "recording/play/played_file.hpp"

namespace g4lidar {

/// *Single thread.* The actions of the recorded driver are repeated at the same places, so the same
/// points result. In a file of bytes every packet produces points.
class replay_player final : public scan_source {
 public:
  replay_player(parts& used, const lidar_options& options);

  [[nodiscard]] result<void> open() override;
  [[nodiscard]] result<void> start() override;
  [[nodiscard]] result<void> stop() override;
  [[nodiscard]] result<answer> ask(const request& wanted, while_scanning if_scanning) override;
  void release(bool rests) noexcept override;

  [[nodiscard]] result<void> can_read() const noexcept override;
  [[nodiscard]] scan_expectation expects() const noexcept override;
  [[nodiscard]] player* controls() noexcept override;
  [[nodiscard]] bool stands() const noexcept override {
    return file_ && file_->clock().is_paused();
  }
  [[nodiscard]] bool has_motor_on() const noexcept override { return false; }
  [[nodiscard]] bool is_scanning() const noexcept override { return stage_ == stage::playing; }
  [[nodiscard]] std::int64_t next_deadline_ns() const noexcept override;
  [[nodiscard]] std::int64_t caller_ns() const noexcept override {
    return source_ != nullptr ? source_->caller_ns() : now_ns();
  }
  [[nodiscard]] std::int64_t deadline_after_ns(std::int64_t timeout_ns) const noexcept override {
    return source_ != nullptr ? source_->deadline_after_ns(timeout_ns)
                              : detail::saturating_add(now_ns(), timeout_ns);
  }
  [[nodiscard]] std::int64_t step_until_ns(std::int64_t deadline_ns) const noexcept override {
    return source_ != nullptr ? source_->recorded_ns(deadline_ns) : deadline_ns;
  }
  void add_to(lidar_counts& counts) const noexcept override { counts.reconnects = lost_.ended; }

 private:
  void follow_samples();

  enum class stage : std::uint8_t {
    closed,
    idle,     ///< Reads, and produces no points.
    playing,  ///< Produces points.
    ending,   ///< No more bytes; produces the last points.
    ended,    ///< Waits until the last scan is taken.
  };

  /// Of the points that follow.
  struct sampling {
    std::uint32_t rate_hz;
    bool is_given;  ///< It stays when the model changes.
    bool counts_times;
  };

  /// What the bytes state about their lidar, and what is recorded of it.
  struct statements {
    identity_reader identity;
    recording_hook* recorder = nullptr;         ///< Of raw bytes, which have no events.
    std::optional<zero_angle> recorded_zero{};  ///< By `recorder`.
    bool is_zero_judged = false;                ///< Whether it is known when points begin.

    void record(const recorded_event& what) {
      recorded_zero = what.zero;
      if (recorder != nullptr) recorder->event(what);
    }
    void follow(const model& model) noexcept {
      identity = identity_reader(model, true);
      is_zero_judged = false;
    }
  };
  /// Of the recorded connection.
  struct losses {
    bool is_lost = false;
    std::uint64_t ended = 0;
  };

  /// The next event, whose place has not been reached yet.
  struct awaited_event {
    std::optional<recorded_event> event{};
    bool is_cut = false;                                ///< For this event; the rest of it follows.
    std::optional<std::array<std::uint8_t, 2>> sent{};  ///< The command since the last read.
  };

  [[nodiscard]] result<void> advance(std::int64_t deadline_ns) override;
  [[nodiscard]] bool parse_bytes();
  [[nodiscard]] result<void> check() const noexcept;
  void follow_seek();
  void follow_delivery();
  void report_long_pause();
  [[nodiscard]] bool play_events(bool all);
  void play(const recorded_event& what);

  played_file* file_ = nullptr;              // null: a pipe
  recorded_event_source* source_ = nullptr;  // of a file
  stage stage_ = stage::closed;
  error why_{task::reading, problem::gone};  // why it ended
  awaited_event next_;
  bool delivers_ = true;            // whether packets produced points in the recording
  bool may_have_more_ = true;       // after the last read
  bool is_pause_reported_ = false;  // the event long_pause was reported
  bool is_released_ = false;
  statements stated_;
  sampling samples_;
  losses lost_;
};

}  // namespace g4lidar
