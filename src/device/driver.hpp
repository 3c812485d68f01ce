// SPDX-License-Identifier: MIT
// What stands behind a lidar: a line that may break, the session on it, and what is to be done next.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "event_queue.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/session.hpp"
#include "g4lidar/stream_parser.hpp"
#include "point_stream.hpp"
#include "read_pace.hpp"
#include "ready_handle.hpp"

namespace g4lidar {

/// The state machine of a driver. *Single thread* but for wake().
///
///     stage        does                                  leaves it for
///     -----------  ------------------------------------  --------------------------------------------
///     closed       nothing                               -
///     lost         connects again, less and less often   identifying
///     identifying  asks who is there                     idle; preparing, if it had been scanning;
///                                                        lost, if it is somebody else
///     idle         what it is asked                      preparing, by start()
///     preparing    health, settings, start               scanning
///     scanning     reads                                 idle, by stop(); preparing, if the device
///                                                        seems to have begun anew
///
/// Any of them is left for lost when the line breaks, or for closed where reconnecting is off.
class G4LIDAR_HIDDEN lidar::driver {
 public:
  driver(std::unique_ptr<connector> connector, const lidar_options& options);
  driver(const driver&) = delete;
  driver& operator=(const driver&) = delete;
  ~driver();

  result<void> open();
  result<void> start();
  result<void> stop();
  result<void> close();
  void release() noexcept;
  result<answer> ask(const request& wanted, while_scanning how);
  result<scan> next_scan(std::int64_t timeout_ns);
  result<std::span<const point>> next_points(std::int64_t timeout_ns);
  result<void> process();
  void wake() noexcept;

  [[nodiscard]] int native_handle() const noexcept { return ready_.native_handle(); }
  [[nodiscard]] std::int64_t next_deadline_ns() const noexcept;
  [[nodiscard]] const device_information& information() const noexcept { return information_; }
  [[nodiscard]] std::string_view name() const noexcept;
  [[nodiscard]] bool is_scanning() const noexcept {
    return stage_ == stage::scanning && wants_scan_;  // else a stop was woken
  }
  [[nodiscard]] lidar_counts counts() const noexcept;
  [[nodiscard]] std::optional<lidar_event> next_event() noexcept { return events_.take(); }
  [[nodiscard]] lidar_ring& points() noexcept { return stream_.ring(); }

 private:
  enum class stage : std::uint8_t { closed, lost, identifying, idle, preparing, scanning };

  /// A request of a plan, and whether the plan fails where it is not answered.
  struct errand {
    request wanted;
    bool needed;
  };

  // The line.
  result<void> connect();
  result<void> hang_up(const error& broken);
  void leave_stopped(const error& why) noexcept;
  std::unique_ptr<transport> exchange_line(std::unique_ptr<transport> made) noexcept;
  void release_line() noexcept;
  void pass_on_wake() noexcept;
  result<void> send(bytes command);
  result<void> send_commands();
  result<void> receive(std::int64_t deadline_ns);
  result<received> read(std::int64_t deadline_ns);
  [[nodiscard]] std::int64_t read_again_ns() const noexcept;
  [[nodiscard]] bool is_batched() const noexcept {
    return options_.batch.count() > 0 && stage_ == stage::scanning;
  }
  result<void> wait_for_line(std::int64_t deadline_ns);

  // One round of everything.
  result<void> step(std::int64_t deadline_ns);
  result<void> round(std::int64_t deadline_ns);
  result<void> serve();
  result<void> look_if_due();
  result<void> take_notice();
  bool digest();
  bool keep_scan();
  void drop_scan() noexcept;
  void take(const event& found);
  void cut_off();
  void end_of_bytes();
  void end_a_silent_frame();
  [[nodiscard]] bool is_waiting_for_answer() const noexcept;
  bool is_delivering();
  void begin_points();
  [[nodiscard]] bool delivers_points() const noexcept;
  [[nodiscard]] result<void> can_read() const noexcept;

  // Recordings.
  void note(line_note::kind what);
  void begin_replay();
  [[nodiscard]] bool is_here(const line_note& what) const noexcept;
  void play_notes(bool all);
  void play(const line_note& what);
  void play_state(const line_note& what);

  // The plan.
  void plan(request wanted, bool needed);
  void plan_start();
  bool set_up_again();
  result<void> go_on_with_plan();
  result<void> finish_errand(const outcome& done);
  result<void> identified(const device_information& who);
  result<void> give_up(const error& why);
  void learn_rate(const outcome& done);
  void remember(const outcome& done);
  void started();
  void back_again();
  result<void> run_plan();
  result<void> begin_question(const request& wanted, while_scanning how);
  [[nodiscard]] error error_of(const outcome& done) const;
  [[nodiscard]] error fallen_silent() const;
  [[nodiscard]] error spoilt(const error& why) const;

  [[nodiscard]] std::int64_t now_ns() const noexcept { return connector_->now_ns(); }
  void tell(lidar_event::kind what, problem reason = problem::timeout) noexcept;

  lidar_options options_;
  std::unique_ptr<connector> connector_;
  std::atomic_flag line_changes_;      // held while line_ changes, and by wake(), which reads it
  std::atomic<bool> woken_ = false;    // a call is to end; seen by step()
  std::atomic<bool> to_kick_ = false;  // and whoever waits is to be told
  std::unique_ptr<transport> line_;
  ready_handle ready_;
  stage stage_ = stage::closed;
  bool opened_ = false;                       // who it is is known
  bool wants_scan_ = false;                   // started, and not stopped
  bool stops_ = false;                        // a stop is planned, and was perhaps woken
  bool has_streamed_ = false;                 // a whole revolution has come since the start
  bool reconnecting_ = false;                 // connected again, and not yet as before
  bool setting_up_again_ = false;             // it may have forgotten what was set
  int set_ups_ = 0;                           // one soon after the other
  std::int64_t set_up_ns_ = 0;                // the last one
  error lost_{task::reading, problem::gone};  // why it is lost or closed
  std::optional<error> refused_;  // why a plan ended, though the line is good; see step()
  device_information information_{};

  session session_;
  stream_parser parser_;
  point_stream stream_;
  event_queue events_;
  stream_counts stream_counts_;
  std::uint64_t bytes_ = 0;

  std::vector<std::uint8_t> buffer_;
  read_pace pace_;
  bytes input_;  // of the buffer, not parsed yet
  std::int64_t arrival_ns_ = 0;
  std::optional<scan> scan_;  // complete, and not taken
  std::uint64_t scans_missed_ = 0;

  std::array<errand, 12> plan_{};
  std::size_t planned_ = 0;
  std::size_t plan_at_ = 0;
  std::optional<outcome> asked_;  // what became of an ask()
  bool asking_ = false;
  std::optional<request> woken_question_;  // of an ask() that was woken, and goes on
  bool delivers_ = false;                  // what comes are points of the scan
  bool has_outcome_ = false;               // one has been taken in this round
  std::uint32_t samples_per_second_ = 9000;

  std::uint32_t events_of_reading_ = 0;  // taken since the last reading
  bool is_replay_ = false;               // the line is a recording
  bool is_played_ = true;                // its points were delivered when it was recorded
  bool is_replay_lost_ = false;          // its line had broken off
  std::optional<line_note> noted_;       // and not come to yet

  std::int64_t last_bytes_ns_ = 0;
  std::int64_t read_until_ns_ = 0;  // what had come by then has been read
  std::int64_t next_attempt_ns_ = 0;
  std::int64_t backoff_ns_ = 0;
  std::uint64_t reconnects_ = 0;

  lidar_ring::reader reader_;
  std::vector<point> points_;
  std::uint64_t points_missed_ = 0;
};

}  // namespace g4lidar
