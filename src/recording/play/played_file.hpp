// SPDX-License-Identifier: MIT
// A file as a transport: the bytes of each read at their times, and the events between the reads.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "g4lidar/core/model.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/recording/contents.hpp"
#include "g4lidar/recording/player.hpp"
#include "g4lidar/recording/reader.hpp"
#include "g4lidar/transport/transport.hpp"
#include "playback_clock.hpp"
#include "transport/fd_port.hpp"

namespace g4lidar {

/// What is in a file, from front to back.
class item_source {
 public:
  virtual ~item_source() = default;
  item_source(const item_source&) = delete;
  item_source& operator=(const item_source&) = delete;

  /// As recording_reader::next().
  [[nodiscard]] virtual result<std::optional<recorded_item>> next() noexcept = 0;
  /// Continues with what was recorded from then on, since the beginning of the file.
  [[nodiscard]] virtual result<void> seek(std::int64_t from_ns) noexcept = 0;
  [[nodiscard]] virtual std::int64_t first_ns() const noexcept = 0;
  [[nodiscard]] virtual std::int64_t last_ns() noexcept = 0;
  /// What sent the bytes. Valid as long as this.
  [[nodiscard]] virtual const g4lidar::model& model() const noexcept = 0;
  /// As which model its driver began to read it.
  [[nodiscard]] virtual const g4lidar::model& begun_as() const noexcept { return model(); }
  /// Null: raw bytes, which have neither events nor times of a device.
  [[nodiscard]] virtual const recording_reader* recording() const noexcept { return nullptr; }
  /// The samples per second by which times of raw bytes are counted; 0: they were recorded.
  [[nodiscard]] virtual std::uint32_t counted_hz() const noexcept { return 0; }

 protected:
  item_source() = default;
};

/// The items of a file in rounds: at its end it may begin again, at later times. *Single thread.*
class item_rounds {
 public:
  /// A wake-up of `waits` also ends the reading.
  item_rounds(std::unique_ptr<item_source> items, std::string_view path,
              const playback_options& options, std::shared_ptr<waker> waits)
      : from_(std::move(items)), path_(path), options_(options), waits_(std::move(waits)) {}

  /// The next item, with its time in the current round; null at the end, and after a failure. Valid until
  /// pop(). Reads without bytes are skipped.
  [[nodiscard]] recorded_item* peek() noexcept;
  void pop() noexcept { item_.reset(); }
  /// Why there is no next item.
  [[nodiscard]] const error& take_why_over() noexcept {
    is_cancelled_ = false;
    return why_over_;
  }
  [[nodiscard]] bool take_cancelled() noexcept { return std::exchange(is_cancelled_, false); }
  /// Continues there, in a first round.
  [[nodiscard]] result<void> seek(std::int64_t from_ns) noexcept;
  void set_loop(bool loops) noexcept { options_.loop = loops; }

  [[nodiscard]] item_source& source() noexcept { return *from_; }
  [[nodiscard]] const item_source& source() const noexcept { return *from_; }
  [[nodiscard]] std::string_view path() const noexcept { return path_; }
  /// The first time of the round.
  [[nodiscard]] std::int64_t first_ns() const noexcept {
    return detail::saturating_add(from_->first_ns(), moved_ns_);
  }

 private:
  [[nodiscard]] recorded_item* find_item() noexcept;
  [[nodiscard]] result<std::optional<recorded_item>> begin_again() noexcept;

  std::unique_ptr<item_source> from_;
  std::string path_;
  playback_options options_;
  std::shared_ptr<waker> waits_;
  std::optional<recorded_item> item_;
  std::int64_t moved_ns_ = 0;  // by the previous rounds
  std::int64_t last_ns_ = 0;
  bool has_read_ = false;  // bytes were read from a device in this round
  bool is_over_ = false;
  bool is_cancelled_ = false;  // not reported yet
  error why_over_{task::reading, problem::end_of_input};
};

class played_file;

/// Of what was guessed, the model as which it is read first; else empty.
[[nodiscard]] std::vector<const model*> candidates_of(const recorded_device& device);

/// The player of a file.
class file_player final : public player {
 public:
  explicit file_player(played_file& of) noexcept : of_(of) {}

  /// `moved` is called within seek(), when the file is at its new position.
  void when_moved(std::function<void()> moved) { moved_ = std::move(moved); }
  /// The lidar is recorded: its times do not go back.
  void forbid_seek() noexcept { may_seek_ = false; }

  void pause(bool pauses) noexcept override;
  [[nodiscard]] bool is_paused() const noexcept override;
  [[nodiscard]] result<void> set_speed(double speed) noexcept override;
  [[nodiscard]] double speed() const noexcept override;
  void set_loop(bool loops) noexcept override;
  [[nodiscard]] result<void> seek(std::int64_t position_ns) noexcept override;
  [[nodiscard]] std::int64_t position_ns() noexcept override;
  [[nodiscard]] std::int64_t begin_ns() noexcept override;
  [[nodiscard]] std::int64_t length_ns() noexcept override;
  [[nodiscard]] std::int64_t wall_ns(std::int64_t time_ns) noexcept override;

 private:
  played_file& of_;
  std::function<void()> moved_;
  bool may_seek_ = true;
};

/// The common part of a connector, its transport and its player: the file, its clock, and its events.
class played_file final : public recorded_event_source {
 public:
  played_file(std::unique_ptr<item_source> items, std::string_view path,
              const playback_options& options, const recorded_device& device,
              std::shared_ptr<waker> waits);

  [[nodiscard]] bool is_open() const noexcept { return waits_->is_open() && due_.get() >= 0; }
  [[nodiscard]] int native_handle() const noexcept { return due_.get(); }
  [[nodiscard]] std::uint32_t baud() const noexcept { return baud_; }
  void wake() noexcept { waits_->wake(); }
  /// Whether a transport may be made: once, and again after each move.
  [[nodiscard]] bool take_connection() noexcept { return std::exchange(may_connect_, false); }

  // As those of a transport.
  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept;
  [[nodiscard]] result<void> wait(std::int64_t until_ns) noexcept;
  [[nodiscard]] bool take_wake() noexcept { return waits_->take() || take_cancelled(); }

  [[nodiscard]] std::optional<recorded_event> next_event() noexcept override;
  [[nodiscard]] const recorded_device& device() const noexcept override { return device_; }
  [[nodiscard]] std::int64_t caller_ns() const noexcept override { return clock_.caller_ns(); }
  [[nodiscard]] std::int64_t deadline_after_ns(std::int64_t timeout_ns) const noexcept override;
  [[nodiscard]] std::int64_t recorded_ns(std::int64_t deadline_ns) const noexcept override {
    return deadline_ns == never_ns ? never_ns : clock_.at_caller_ns(deadline_ns);
  }
  [[nodiscard]] std::int64_t wait_for_next_ns() noexcept override;
  [[nodiscard]] bool take_cancelled() noexcept override { return items_.take_cancelled(); }

  /// Wall clock minus the times, where it is known.
  [[nodiscard]] std::optional<std::int64_t> wall_ahead_ns() noexcept;
  [[nodiscard]] playback_clock& clock() noexcept { return clock_; }
  [[nodiscard]] item_rounds& items() noexcept { return items_; }
  [[nodiscard]] const item_rounds& items() const noexcept { return items_; }
  [[nodiscard]] file_player& controls() noexcept { return controls_; }
  /// The clock was changed.
  void follow_clock() noexcept;
  /// Continues there, in a first round.
  [[nodiscard]] result<void> move_to(std::int64_t position_ns) noexcept;

 private:
  void set_handle(std::int64_t at_ns) noexcept;
  void set_handle_for_next() noexcept;
  void follow_wall_clock(const recorded_item& item) noexcept {
    wall_ahead_ns_ = detail::saturating_sub(item.wall_ns, item.time_ns);
  }

  item_rounds items_;
  playback_clock clock_;
  std::shared_ptr<waker> waits_;
  owned_fd due_;
  recorded_device device_;
  file_player controls_{*this};
  std::uint32_t baud_ = 0;
  std::optional<std::int64_t> wall_ahead_ns_;
  std::int64_t set_for_ns_ = never_ns;  // when the handle is readable; never_ns: not set
  bool is_shown_ = false;               // next_event() has returned the next item
  bool may_connect_ = true;
};

/// What is wrong with the options, if so.
[[nodiscard]] std::optional<error> problem_with(const playback_options& options) noexcept;

/// To the transport of a file that is played.
[[nodiscard]] result<std::unique_ptr<connector>> connect_to(std::shared_ptr<played_file> file);
/// The file that the connector, or one that it wraps, plays; null if none does.
[[nodiscard]] played_file* file_of(connector& from) noexcept;

}  // namespace g4lidar
