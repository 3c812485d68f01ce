// SPDX-License-Identifier: MIT
// Observes a transport byte by byte and sends commands on it: the base of the live stages.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "g4lidar/core/command.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/stream_counter.hpp"
#include "g4lidar/discovery.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/transport/transport.hpp"
#include "link/device_link.hpp"
#include "survey/stream_survey.hpp"

namespace g4lidar {

inline constexpr std::int64_t ms = 1'000'000;  // in ns
/// The longest wait of a read, so that a cancellation and a pause of the host are noticed, and silence is certain.
inline constexpr std::int64_t longest_read_ns = 50 * ms;
/// A read that takes this much longer was delayed by the host.
inline constexpr std::int64_t host_pause_after_ns = 25 * ms;

/// An event of the parser, its bytes, and when the last of them arrived.
struct observed_event {
  const event& what;
  bytes raw;
  std::int64_t arrival_ns;
};

/// Bytes of one read.
struct timed_read {
  std::size_t count;
  std::int64_t arrival_ns;
  std::int64_t silence_ns = 0;     ///< Before them, while the program was waiting.
  std::int64_t host_pause_ns = 0;  ///< How long the program was suspended before them.
  bool is_backlog = false;         ///< They were waiting since such a pause.
};

/// Receives the observations. Either may be empty.
struct observer {
  std::function<void(const observed_event&)> event{};
  std::function<void(const timed_read&)> arrival{};
};

/// Splits bytes into events with their bytes, and detects boot texts. *Single thread.*
class event_splitter {
 public:
  event_splitter() = default;
  explicit event_splitter(sample_format format) noexcept : input_(format) {}

  void take(bytes data, std::int64_t arrival_ns, const observer& to);
  /// The held bytes have ended.
  void finish(const observer& to);
  /// Where a device_link reads: its input, the bytes of one read before their events, and what takes the events.
  [[nodiscard]] event_reader& input() noexcept { return input_; }
  void received(bytes data);
  [[nodiscard]] auto sink(const observer& to) noexcept {
    return [this, &to](const event& found) { give(found, to); };
  }
  /// Counts of all events so far.
  [[nodiscard]] const stream_counts& counts() const noexcept { return counts_; }
  /// Boot texts so far.
  [[nodiscard]] std::uint64_t boots() const noexcept { return boots_; }

 private:
  void give(const event& found, const observer& to);
  void give_all(const observer& to);
  void look_for_text(bytes raw);

  event_reader input_;
  stream_counter counts_;
  std::vector<std::uint8_t> raw_;  // not part of an event yet
  std::size_t raw_begin_ = 0;
  std::uint64_t boots_ = 0;
  /// Characters in a row.
  struct text_run {
    std::size_t size = 0;
    std::size_t words = 0;    // those of words
    bool has_end = false;     // of a line
    bool is_spoiled = false;  // it began in the middle of other bytes
    bool is_counted = false;
  } text_;
};

/// A command and the replies to it.
struct exchange {
  command asked{};
  std::int64_t asked_ns = 0;
  std::int64_t answered_ns = -1;  ///< -1: not answered.
  std::vector<std::uint8_t> reply{};
  unsigned copies = 0;  ///< Of the same reply, after the first.
  unsigned wrong = 0;   ///< Replies that cannot belong to this command.
  std::uint64_t packets = 0;
  std::uint64_t skipped = 0;  ///< Bytes outside packets and responses.
  bool is_disturbed = false;  ///< By a boot or a pause of the host: its times have no meaning.

  [[nodiscard]] bool is_answered() const noexcept { return answered_ns >= 0; }
  [[nodiscard]] std::int64_t latency_ns() const noexcept { return answered_ns - asked_ns; }
  [[nodiscard]] bool heard_nothing() const noexcept {
    return !is_answered() && wrong == 0 && packets == 0 && skipped == 0;
  }
};

/// What was observed during a search.
struct search_record {
  std::uint64_t bytes = 0;    ///< At all rates.
  std::uint64_t unasked = 0;  ///< Bytes before the first question, at all rates.
  stream_counts counts{};
  std::int64_t asked_ns =
      -1;  ///< The first question at the rate of the lidar, if it may not have been answered.
  std::optional<stream_survey> other{};  ///< What sends, if it is known and no lidar as it is.
};

/// *Single thread.* After a loss (error()) nothing arrives, and every call returns immediately.
class link_monitor {
 public:
  /// Longer than the pauses within an answer.
  static constexpr std::int64_t usual_cut_off_ns = 60 * ms;

  /// `model` sends the packets; valid as long as this. `is_mute`: not a byte is sent, whatever is called.
  link_monitor(std::unique_ptr<transport> opened, std::function<bool()> is_cancelled,
               const model& model = g4_model, bool is_mute = false);

  /// Observes until `until_ns`, which the observer may change.
  void listen(const std::int64_t& until_ns, const observer& to);
  void listen_for(std::int64_t time_ns) { listen(now_ns() + time_ns, {}); }
  /// Observes until nothing has arrived for `quiet_ns`, at most until `until_ns`.
  void listen_for_quiet(std::int64_t quiet_ns, std::int64_t until_ns);
  /// A packet or response that does not continue for this time has ended. On a link that stalls it takes longer.
  void set_cut_off_after(std::int64_t pause_ns = usual_cut_off_ns) noexcept {
    link_.set_cut_off_after(pause_ns);
  }

  void send(command code) { static_cast<void>(write(encode(code))); }
  /// Sends a command and waits at most `patience_ns` for the reply, then shortly for a copy of it.
  [[nodiscard]] exchange ask(command code, std::int64_t patience_ns);
  /// Waits for the reply to a command that was sent before.
  void await(exchange& made, std::int64_t patience_ns);
  /// Stops the device, with up to three attempts. Returns whether it is silent. If reading has failed, a
  /// write may still stop the motor.
  bool stop();

  [[nodiscard]] std::int64_t now_ns() const noexcept { return transport_->now_ns(); }
  /// The error that ended the connection.
  [[nodiscard]] const std::optional<error>& failure() const noexcept { return error_; }
  /// From now on the run cannot be cancelled: only the motor is to be stopped.
  void ignore_cancel() noexcept {
    is_cancelled_ = nullptr;
    cancelled_ = false;
  }
  [[nodiscard]] bool is_over() const noexcept { return cancelled_ || error_; }
  /// When the last byte arrived.
  [[nodiscard]] std::int64_t heard_ns() const noexcept { return link_.heard_ns(); }
  [[nodiscard]] std::uint64_t boots() const noexcept { return boots_before_ + splitter_.boots(); }
  /// Counts of everything observed since read_as(), search() or set_baud().
  [[nodiscard]] const stream_counts& counts() const noexcept { return splitter_.counts(); }
  /// When the last pause of the host ended that was as long as a stall of the lidar; 0: there was none.
  [[nodiscard]] std::int64_t host_paused_ns() const noexcept { return host_paused_ns_; }
  /// Pauses of the host of any length.
  [[nodiscard]] std::uint64_t host_pauses() const noexcept { return host_pauses_; }
  /// The size of samples in the last packets that showed it, whatever model they were read as; 0: none has.
  [[nodiscard]] std::size_t sample_bytes() const noexcept {
    const std::size_t seen = survey_.layout().sample_bytes();
    return seen != 0 ? seen : sample_bytes_;
  }
  /// Of all that was received and sent, but by search().
  [[nodiscard]] const stream_survey& survey() const noexcept { return survey_; }
  /// Where the bytes come from.
  [[nodiscard]] transport& port() const noexcept { return *transport_; }
  /// The bytes that follow are those of a lidar like `model`, valid as long as this, and do not continue
  /// the earlier ones.
  void read_as(const model& model);
  /// Finds the lidar at the transport, as search() does, in this time, which begins now.
  [[nodiscard]] result<recognised_lidar> search(const search_options& known, std::int64_t time_ns);
  /// Of the last one.
  [[nodiscard]] const search_record& searched() const noexcept { return searched_; }
  /// Sets the rate of the transport, if it has one that can be changed; returns whether it has.
  bool set_baud(std::uint32_t baud);

 private:
  result<void> write(bytes data);

  std::unique_ptr<transport> transport_;
  std::function<bool()> is_cancelled_;
  const model* which_;
  std::optional<error> error_;
  bool cancelled_ = false;
  bool is_mute_;
  bool has_backlog_ = false;
  std::int64_t read_ns_ = -1;  // the end of the last read
  event_splitter splitter_;
  std::uint64_t boots_before_ = 0;  // observed by earlier splitters
  device_link link_;
  std::array<std::uint8_t, 4096> buffer_{};
  std::int64_t silence_ns_ = 0;
  std::size_t sample_bytes_ = 0;  // before the last read_as()
  std::uint64_t host_pauses_ = 0;
  std::int64_t host_paused_ns_ = 0;
  stream_survey survey_;
  search_record searched_;
};

/// Lowers the line DTR for this time, which stops a motor that it drives, and raises it. False if there is none.
inline bool pulse_dtr(link_monitor& link, std::int64_t low_ns = 120 * ms) {
  if (link.is_over() || !link.port().set_dtr(false).value_or(false)) return false;
  link.listen_for(low_ns);
  const bool is_high = link.port().set_dtr(true).value_or(false);
  return is_high && !link.is_over();
}

}  // namespace g4lidar
