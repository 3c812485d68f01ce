// SPDX-License-Identifier: MIT
// The single acts of talking to a device: make it silent, ask it, start it, restart it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <variant>

#include "g4lidar/command.hpp"
#include "g4lidar/pending_question.hpp"
#include "g4lidar/response.hpp"
#include "g4lidar/scan_watch.hpp"
#include "g4lidar/stream_parser.hpp"

namespace g4lidar {

/// What has become of an act.
enum class talk_state : std::uint8_t {
  going_on,
  quiet,        ///< Of drain(): nothing comes any more, or only noise.
  streaming,    ///< Of drain(): packets come although it was told to stop, often.
  answered,     ///< Of ask(): by the response just shown.
  wrong,        ///< Of ask(): the response just shown cannot be the answer. Still going on.
  lost,         ///< Of ask() and clear(): the line is clear, and there is no answer.
  silent,       ///< Of ask(), clear() and restart(): no answer to anything.
  disturbed,    ///< Of ask(), clear() and restart(): a packet came.
  running,      ///< Of start(): the scan header or a packet came.
  not_started,  ///< Of start(): neither.
  restarted,    ///< Of restart(): it answers again.
};

/// One act at a time, each with an end in bounded time. *Single thread.* session has the table.
class device_talk {
 public:
  /// At rest, with these times.
  explicit constexpr device_talk(const session_times& times) noexcept : times_(times) {}

  /// Tells the device to stop and waits for silence.
  constexpr void drain(std::int64_t now_ns) noexcept {
    drains_ = 0;
    tell_to_stop(now_ns);
  }
  /// Asks; see pending_question. After a disturbance clear() goes on with the same question, when
  /// the device is quiet, and so it does after an answer that the caller does not believe.
  constexpr void ask(command code, bool is_foretold, std::int64_t now_ns) noexcept {
    question_.ask(code, is_foretold);
    send_question(now_ns);
  }
  /// Clears the line, and asks the same question again.
  constexpr void clear(std::int64_t now_ns) noexcept {
    question_.clear();
    send_question(now_ns);
  }
  /// Starts the scan: ends with running or not_started.
  constexpr void start(std::int64_t now_ns) noexcept {
    send(command::start);
    enter(act::starting, now_ns + times_.start_ns);
  }
  /// Restarts the device: ends with restarted or silent.
  constexpr void restart(std::int64_t now_ns) noexcept {
    is_old_ = false;
    boot_until_ns_ = now_ns + times_.boot_ns;
    await_boot(command::restart, now_ns);
  }
  /// Ends the act.
  constexpr void rest() noexcept { act_ = act::none; }
  /// Sends without waiting for anything.
  constexpr void send(command code) noexcept {
    queue_[0] = code;  // what has not been fetched yet is out of date
    queued_ = 1;
    fetched_ = 0;
  }
  /// Sends both forms of a stop, without waiting for anything.
  constexpr void send_stop() noexcept {
    queue_ = {command::forced_stop, command::stop};
    queued_ = 2;
    fetched_ = 0;
  }

  /// An event of the parser.
  [[nodiscard]] constexpr talk_state take(const event& found, std::int64_t now_ns) noexcept {
    heard_ns_ = std::max(heard_ns_, now_ns);
    has_signs_ = !is_unsent();
    if (const auto* heard = std::get_if<response_view>(&found)) return on_response(*heard, now_ns);
    if (std::get_if<packet_view>(&found) != nullptr) return on_packet();
    return talk_state::going_on;
  }

  /// Time has passed.
  [[nodiscard]] constexpr talk_state look(std::int64_t now_ns) noexcept {
    if (now_ns < next_look_ns()) return talk_state::going_on;
    switch (act_) {
      case act::draining:
        if (now_ns >= heard_ns_ + times_.quiet_ns) return talk_state::quiet;
        if (drains_ == max_drains) return has_packets_ ? talk_state::streaming : talk_state::quiet;
        tell_to_stop(now_ns);
        break;
      case act::asking:
        return on_question(question_.late(), now_ns);
      case act::starting:
        return talk_state::not_started;
      case act::booting:
        has_signs_ || is_old_ ? probe(now_ns) : await_boot(command::restart_old, now_ns);
        break;
      case act::probing:
        if (now_ns >= boot_until_ns_) return talk_state::silent;
        probe(now_ns);
        break;
      case act::none:
        break;
    }
    return talk_state::going_on;
  }

  /// When look() is due, whatever comes; the highest value where it is not.
  [[nodiscard]] constexpr std::int64_t next_look_ns() const noexcept {
    switch (act_) {
      case act::none:
        return std::numeric_limits<std::int64_t>::max();
      case act::draining:
        return std::min(heard_ns_ + times_.quiet_ns, deadline_ns_);
      case act::booting:
        if (has_signs_) return std::min(heard_ns_ + 2 * times_.quiet_ns, boot_until_ns_);
        break;
      default:
        break;
    }
    return deadline_ns_;
  }

  /// The next command to be written to the line, each once; nothing where there is none.
  [[nodiscard]] constexpr std::optional<std::array<std::uint8_t, 2>> to_send() noexcept {
    if (!is_unsent()) return std::nullopt;
    return encode(queue_[fetched_++]);
  }

  /// Whether a command has not been fetched yet: what comes now is no answer to it.
  [[nodiscard]] constexpr bool is_unsent() const noexcept { return fetched_ != queued_; }
  /// Whether no act is under way.
  [[nodiscard]] constexpr bool is_at_rest() const noexcept { return act_ == act::none; }
  /// Whether it waits for silence.
  [[nodiscard]] constexpr bool is_draining() const noexcept { return act_ == act::draining; }
  /// What is asked, or was last.
  [[nodiscard]] constexpr pending_question& question() noexcept { return question_; }
  /// As they were given.
  [[nodiscard]] constexpr const session_times& times() const noexcept { return times_; }

 private:
  friend struct session_state;  // of the test that explores all of them

  enum class act : std::uint8_t { none, draining, asking, starting, booting, probing };

  static constexpr int max_drains = 3;  // times that a device is told to stop

  constexpr void enter(act next, std::int64_t deadline_ns) noexcept {
    act_ = next;
    deadline_ns_ = deadline_ns;
  }
  constexpr void tell_to_stop(std::int64_t now_ns) noexcept {
    ++drains_;
    has_packets_ = false;
    heard_ns_ = now_ns;
    send_stop();
    enter(act::draining, now_ns + times_.drain_ns);
  }
  constexpr void send_question(std::int64_t now_ns) noexcept {
    send(question_.code_to_send());
    enter(act::asking, now_ns + question_.patience() * times_.answer_ns);
  }
  constexpr void await_boot(command code, std::int64_t now_ns) noexcept {
    is_old_ = code == command::restart_old;
    has_signs_ = false;
    send(code);
    enter(act::booting, now_ns + times_.boot_sign_ns);
  }
  constexpr void probe(std::int64_t now_ns) noexcept {
    send(command::device_info);
    enter(act::probing, now_ns + times_.answer_ns);
  }

  constexpr talk_state on_question(question_state now, std::int64_t now_ns) noexcept {
    switch (now) {
      case question_state::waiting:
        break;
      case question_state::send:
        send_question(now_ns);
        break;
      case question_state::answered:
        return talk_state::answered;
      case question_state::lost:
        return talk_state::lost;
      case question_state::silent:
        return talk_state::silent;
    }
    return talk_state::going_on;
  }

  constexpr talk_state on_response(const response_view& heard, std::int64_t now_ns) noexcept {
    if (is_unsent()) {
      question_.take_unasked(heard);
      return talk_state::going_on;
    }
    switch (act_) {
      case act::asking: {
        const bool was_clearing = question_.is_clearing();
        const talk_state now = on_question(question_.take(heard), now_ns);
        return !was_clearing && question_.is_clearing() ? talk_state::wrong : now;
      }
      case act::starting:
        if (heard.kind() == response_kind::scan_started) return talk_state::running;
        break;
      case act::probing:
        if (heard.kind() != response_kind::device_info) break;
        question_.take_unasked(heard);  // it may have said so by itself, and answer yet
        return talk_state::restarted;
      case act::none:
      case act::draining:
      case act::booting:
        question_.take_unasked(heard);
        break;
    }
    return talk_state::going_on;
  }

  constexpr talk_state on_packet() noexcept {
    has_packets_ = true;
    if (act_ == act::starting) return is_unsent() ? talk_state::going_on : talk_state::running;
    const bool is_free = act_ == act::none || act_ == act::draining;
    return is_free ? talk_state::going_on : talk_state::disturbed;
  }

  session_times times_;
  pending_question question_;
  act act_ = act::none;
  std::uint8_t drains_ = 0;
  bool has_packets_ = false;  // packets came after it was told to stop
  bool has_signs_ = false;    // anything came after it was told to restart
  bool is_old_ = false;       // it has been told so in the old way
  std::uint8_t queued_ = 0;
  std::uint8_t fetched_ = 0;
  std::array<command, 2> queue_{};
  std::int64_t heard_ns_ = 0;
  std::int64_t deadline_ns_ = 0;
  std::int64_t boot_until_ns_ = 0;
};

}  // namespace g4lidar
